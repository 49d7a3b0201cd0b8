/* SPDX-License-Identifier: BSD-3-Clause */
/* Names of areas as people write them: separators, sides before or behind, and what has two readings. */
#include "atlas/areas/areas.h"
#include "builders/area_rows.h"
#include "test.h"

#include <string.h>

/* The last ones have a side by their table alone. */
static const struct area_row rows[] = {
    {1, "Hippocampus_L", 0, "HIP.L", 0},
    {2, "Hippocampus_R", 0, "HIP.R", 0},
    {3, "Left-Thalamus-Proper", 0, NULL, 0},
    {4, "Right-Thalamus-Proper", 0, NULL, 0},
    {5, "ctx-lh-insula", 0, NULL, 0},
    {6, "ctx-rh-insula", 0, NULL, 0},
    {7, "Area Fp1 (FPole) left", 0, NULL, 0},
    {8, "Frontal Pole", 0, NULL, 0},
    {9, "Vermis_4_5", 0, NULL, 0},
    {17, "V1", 0, NULL, 0},
    {18, "Heschl's Gyrus, part a", 0, NULL, 0},
    {19, "bankssts", 0, NULL, 'L'},
    {20, "bankssts", 0, NULL, 'R'},
    {21, "Layer L", 0, NULL, 0},
    {22, "Pole Frontal", 0, NULL, 0},
    {23, "Only_R", 0, NULL, 0},
    {0, NULL, 0, NULL, 0},
};
static const size_t dim[3] = {4, 1, 1};
static const uint32_t labels[4] = {1, 2, 3, 4};

static conus_atlas *atlas;

static int open_atlas(void **state)
{
    (void)state;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(area_rows_add_pathway(atlas, "Arcuate_L"));
    assert_ok(area_rows_add_pathway(atlas, "Arcuate_R"));
    return 0;
}

static int close_atlas(void **state)
{
    (void)state;
    conus_atlas_destroy(atlas);
    return 0;
}

static void names_are_found_as_people_write_them(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t label;
        const char *name;
    } cases[] = {
        {"Hippocampus_L", 1, NULL},
        {"hippocampus_l", 1, NULL},
        {"hippocampus l", 1, NULL},
        {"Hippocampus L", 1, NULL},
        {"left hippocampus", 1, NULL},
        {"Right  Hippocampus", 2, NULL},
        {"L. Hippocampus", 1, NULL},
        {"lh hippocampus", 1, NULL},
        {"Hippocampus (left)", 1, NULL},
        {"hippocampus, right", 2, NULL},
        {"HIP-R", 2, NULL},
        {"left hip", 1, NULL},
        {"left thalamus proper", 3, NULL},
        {"Thalamus_Proper_R", 4, NULL},
        {"Left Thalamus-Proper", 3, NULL},
        {"ctx insula left", 5, NULL},
        {"rh ctx insula", 6, NULL},
        {"ctx_rh_insula", 6, NULL},
        {"area fp1 fpole left", 7, NULL},
        {"left Area Fp1 [FPole]", 7, NULL},
        {"frontal-pole", 8, NULL},
        {"vermis 4 5", 9, NULL},
        {"17", 17, NULL},
        {"vermis 4-5", 9, NULL},
        {"Heschl's Gyrus part a", 18, NULL},
        {"left bankssts", 19, NULL},
        {"bankssts rh", 20, NULL},
        {"layer-l", 21, NULL},
        {"pole frontal", 22, NULL},
        {"only right", 23, NULL},
        {"arcuate left", 0, "Arcuate_L"},
        {"R arcuate", 0, "Arcuate_R"},
        {"left\xc2\xa0hippocampus", 1, NULL}, /* a no-break space, */
        {"Frontal\xe2\x80\x89Pole", 8, NULL}, /* and a thin one */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint32_t found = 0;
        if (object_find(&found, atlas, text_from(cases[i].text))) {
            fail_msg("%s: %s", cases[i].text, conus_message());
        }
        const conus_object *object = conus_atlas_object(atlas, found);
        bool is_right = cases[i].name ? strcmp(object->name, cases[i].name) == 0 : object->label == cases[i].label;
        if (!is_right) {
            fail_msg("%s: found %s", cases[i].text, object->name);
        }
    }
}

static void what_may_be_several_is_refused_with_names(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"hippocampus", "\"hippocampus\" may be any of 2: \"Hippocampus_L\" (1), \"Hippocampus_R\" (2); give"},
        {"bankssts", "\"left bankssts\" (19), \"right bankssts\" (20)"},
        {"ctx insula", "\"ctx-lh-insula\" (5), \"ctx-rh-insula\" (6)"},
        {"arcuate", "\"Arcuate_L\", \"Arcuate_R\"; give"},
        {"left V1", "\"V1\" has no sides here; --hemispheres split makes \"V1 left\" of it"},
        {"frontal pole R", "\"Frontal Pole right\" of it"},
        {"Only_R left", "\"Only_R\" is on the right by its name: which side is meant?"},
        {"only", "no area or pathway has the name, abbreviation or label \"only\"; did you mean \"Only_R\"?"},
        {"left only", "no area or pathway"},
        {"left hippocampus right", "no area or pathway"},
        {"left", "no area or pathway"},
        {"left left", "no area or pathway"},
        {"_", "no area or pathway"},
        {"-17", "no area or pathway"},
        {"vermis 4 -5", "no area or pathway"},
        {"hippocampal", "no area or pathway"},
        {"thalamus", "did you mean \"Left-Thalamus-Proper\" or \"Right-Thalamus-Proper\"?"},
        {"Hippocampus_X", "did you mean \"Hippocampus_L\" or \"Hippocampus_R\"?"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint32_t found = 77;
        assert_fails(object_find(&found, atlas, text_from(cases[i].text)), CONUS_ERROR_ARGUMENT);
        assert_int_equal(found, 77);
        if (!strstr(conus_message(), cases[i].message)) {
            fail_msg("%s: said %s", cases[i].text, conus_message());
        }
    }
}

static void many_are_listed_up_to_twelve(void **state)
{
    (void)state;
    struct area_row many[16] = {{0}};
    static const uint32_t one[1] = {1};
    uint32_t found;
    conus_atlas *crowd = NULL;
    for (uint32_t i = 0; i < 14; i++) {
        many[i] = (struct area_row){i + 1, "same", 0, NULL, 0};
    }
    assert_ok(area_rows_atlas(&crowd, (const size_t[]){1, 1, 1}, one, many));
    assert_fails(area_find(&found, crowd, text_from("same")), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "any of 14: "));
    assert_non_null(strstr(conus_message(), "(12), ...; give"));
    assert_null(strstr(conus_message(), "(13)"));
    conus_atlas_destroy(crowd);
}

static conus_status find_each(void *user)
{
    (void)user;
    uint32_t found;
    conus_status status = object_find(&found, atlas, text_from("hippocampus"));
    conus_status other = object_find(&found, atlas, text_from("thalamus"));
    return status == CONUS_ERROR_MEMORY || other == CONUS_ERROR_MEMORY ? CONUS_ERROR_MEMORY : CONUS_OK;
}

static void memory_may_fail(void **state)
{
    (void)state;
    test_every_allocation(find_each, NULL);
}

TEST_GROUP(area_find)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_found_as_people_write_them),
        cmocka_unit_test(what_may_be_several_is_refused_with_names),
        cmocka_unit_test(many_are_listed_up_to_twelve),
        cmocka_unit_test(memory_may_fail),
    };
    return cmocka_run_group_tests(tests, open_atlas, close_atlas);
}
