/* SPDX-License-Identifier: BSD-3-Clause */
/* The part of Eq. 10 that rolls areas up the tree. */
#include "atlas/areas/areas.h"
#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* Brain (1) has Cortex (2) and Thalamus (3); Cortex has V1 (4, with layers 6 and 7) and "A1, core" (5). Alone (30) is
 * a root. Labels do not follow the tree. */
static const struct area_row rows[] = {
    {1, "Brain", 0, "BR", 0},           {20, "Cortex", 1, "CTX", 0},    {3, "Thalamus", 1, "TH", 0},
    {14, "V1", 20, "VISp", 0},          {5, "A1, core", 20, "AUDp", 0}, {16, "V1, layer 4", 14, "VISp4", 0},
    {7, "V1, layer 5", 14, "VISp5", 0}, {30, "Alone", 0, "cm", 0},      {31, "alone too", 0, "CM", 0},
    {32, "Same", 0, NULL, 0},           {33, "Same", 0, NULL, 0},       {0, NULL, 0, NULL, 0},
};
static const size_t dim[3] = {8, 1, 1};
static const uint32_t labels[8] = {3, 14, 5, 16, 7, 30, 0, 99};

static conus_atlas *atlas;

static int open_atlas(void **state)
{
    (void)state;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(area_rows_add_pathway(atlas, "CST"));
    return 0;
}

static int close_atlas(void **state)
{
    (void)state;
    conus_atlas_destroy(atlas);
    return 0;
}

/* The names under which `spec` reports the areas of these voxels, in the order of `labels`, with bars between. */
static const char *rolled(const char *spec)
{
    static char names[512];
    struct level *level = NULL;
    names[0] = '\0';
    assert_ok(level_create(&level, atlas, spec));
    for (size_t i = 0; i < 8; i++) {
        const conus_object *area = conus_atlas_object(atlas, level_group(level)[volume_object(&atlas->volumes[0], i)]);
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", i ? "|" : "", area ? area->name : "-");
    }
    size_t last = conus_atlas_object_count(atlas);
    assert_int_equal(level_group(level)[0], 0);
    assert_int_equal(level_group(level)[last], last); /* the pathway */
    level_destroy(level);
    return names;
}

static void a_depth_cuts_the_tree(void **state)
{
    (void)state;
    assert_string_equal(rolled("1"), "Brain|Brain|Brain|Brain|Brain|Alone|-|99");
    assert_string_equal(rolled("2"), "Thalamus|Cortex|Cortex|Cortex|Cortex|Alone|-|99");
    assert_string_equal(rolled(" 3 "), "Thalamus|V1|A1, core|V1|V1|Alone|-|99");
    assert_string_equal(rolled("4"), rolled(NULL));
    struct level *level = NULL;
    assert_ok(level_create(&level, atlas, "4"));
    assert_true(level_is_identity(level));
    level_destroy(level);
    assert_ok(level_create(&level, atlas, "3"));
    assert_false(level_is_identity(level));
    level_destroy(level);
}

static void a_list_takes_the_nearest(void **state)
{
    (void)state;
    assert_string_equal(rolled("Cortex"), "Thalamus|Cortex|Cortex|Cortex|Cortex|Alone|-|99");
    assert_string_equal(rolled("V1, Brain"), "Brain|V1|Brain|V1|V1|Alone|-|99");
    assert_string_equal(rolled("VISp,TH"), "Thalamus|V1|A1, core|V1|V1|Alone|-|99");
    assert_string_equal(rolled("\"20\""), rolled("Cortex")); /* a label, not a depth */
    assert_string_equal(rolled("20,14"), rolled("CTX,VISp"));
    assert_string_equal(rolled("visp"), rolled("V1"));
    assert_string_equal(rolled("\"A1, core\" , cortex"), "Thalamus|Cortex|A1, core|Cortex|Cortex|Alone|-|99");
    assert_string_equal(rolled("\"V1, layer 4\""), rolled(NULL));
    assert_string_equal(rolled("cm"), rolled(NULL)); /* to the letter, though there is CM, too */
}

static const char *write_list(const char *text)
{
    static char spec[600];
    const char *path = test_scratch("areas.txt");
    assert_ok(conus_write_file(path, text, strlen(text)));
    snprintf(spec, sizeof spec, "@%s", path);
    return spec;
}

static void a_file_has_an_area_per_line(void **state)
{
    (void)state;
    char both[700];
    assert_string_equal(rolled(write_list("\xef\xbb\xbf# mine\r\n\r\nA1, core\r\n  Cortex  ")),
                        rolled("\"A1, core\",Cortex"));
    assert_string_equal(rolled(write_list("20\n")), rolled("Cortex"));
    assert_string_equal(rolled(write_list("")), rolled(NULL));
    snprintf(both, sizeof both, "%s, Brain", write_list("V1\n"));
    assert_string_equal(rolled(both), rolled("V1,Brain"));
}

static void refuse(const char *spec, conus_status wanted, const char *message)
{
    struct level *level = NULL;
    assert_fails(level_create(&level, atlas, spec), wanted);
    assert_null(level);
    if (!strstr(conus_message(), message) || strncmp(conus_message(), "level: ", 7) != 0) {
        fail_msg("\"%s\": said %s; wanted %s", spec, conus_message(), message);
    }
}

static void bad_levels_are_explained(void **state)
{
    (void)state;
    static const struct {
        const char *spec, *message;
    } cases[] = {
        {"0", "depth 0, the area tree has depths 1 to 4"},
        {"5", "depth 5, the area tree has depths 1 to 4"},
        {"Thalmus", "\"Thalmus\"; did you mean \"Thalamus\"?"},
        {"thal", "did you mean \"Thalamus\"?"},
        {"VISp6", "did you mean \"VISp5\", \"VISp\" or \"VISp4\"?"},
        {"V1, layer 4", "\"layer 4\"; did you mean \"V1, layer 4\"? Names with commas are put in double quotes"},
        {"Xyzzy", "no area has the name, abbreviation or label \"Xyzzy\""},
        {"Cm", "\"Cm\" may be any of 2: "},
        {"Same", "\"Same\" may be any of 2: \"Same\" (32), \"Same\" (33); give a name or a label"},
        {"CST", "\"CST\" is a pathway"},
        {"", "an area is missing"},
        {"V1,,Brain", "an area is missing"},
        {"V1,", "an area is missing"},
        {"\"V1", "\"V1: the closing quote is missing"},
        {"\"V1\" Brain", "\"V1\" is followed by \"Brain\", a comma is needed"},
        {"\"\"", "an area is missing"},
        {"@", "@FILE has one area per line"},
        {"-1", "label \"-1\""},
        {"1.5", "label \"1.5\""},
        {"18446744073709551616", "label \"18446744073709551616\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        refuse(cases[i].spec, CONUS_ERROR_ARGUMENT, cases[i].message);
    }
    refuse("@/nowhere/areas.txt", CONUS_ERROR_IO, "/nowhere/areas.txt");
    refuse(write_list("V1\n\nBrian\n"), CONUS_ERROR_ARGUMENT, "areas.txt: line 3: no area has the name");
}

/* Every prefix of a spec gives a level or a message of one line. */
static void every_prefix_is_answered(void **state)
{
    (void)state;
    static const char spec[] = "\"A1, core\" , @/nowhere/a, VISp5,20";
    char prefix[sizeof spec];
    for (size_t length = 0; length < sizeof spec; length++) {
        struct level *level = NULL;
        memcpy(prefix, spec, length);
        prefix[length] = '\0';
        conus_status status = level_create(&level, atlas, prefix);
        assert_true(status ? !level && !strchr(conus_message(), '\n') : level != NULL);
        level_destroy(level);
    }
}

static void an_atlas_without_a_tree_is_told(void **state)
{
    (void)state;
    static const struct area_row flat[] = {{3, "A", 0, NULL, 0}, {14, "B", 0, NULL, 0}, {0, NULL, 0, NULL, 0}};
    conus_atlas *other = NULL;
    struct level *level = NULL;
    assert_ok(area_rows_atlas(&other, dim, labels, flat));
    assert_fails(level_create(&level, other, "2"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "level: the atlas has no area tree: none of its 7 areas is part of another");
    assert_fails(level_create(&level, other, "A"), CONUS_ERROR_ARGUMENT);
    assert_ok(level_create(&level, other, NULL));
    assert_true(level_is_identity(level));
    level_destroy(level);
    conus_atlas_destroy(other);
}

static conus_status make_level(void *spec)
{
    struct level *level = NULL;
    conus_status status = level_create(&level, atlas, spec);
    level_destroy(level);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    test_every_allocation(make_level, "2");
    test_every_allocation(make_level, (void *)write_list("V1\nBrain\n"));
}

/* A chain of a hundred thousand areas, each listed before its parent. */
static void a_deep_tree_is_quick(void **state)
{
    (void)state;
    enum { DEEP = 100000 };
    conus_atlas *deep = NULL;
    struct level *level = NULL;
    assert_ok(atlas_create_empty(&deep, "deep"));
    for (uint32_t i = 1; i <= DEEP; i++) {
        const conus_object area = {
            .kind = CONUS_KIND_AREA, .label = i, .name = "n", .abbreviation = "", .parent = i < DEEP ? i + 1 : 0};
        assert_ok(atlas_add_group(deep, &area));
    }
    assert_ok(level_create(&level, deep, "100000"));
    assert_true(level_is_identity(level));
    level_destroy(level);
    assert_ok(level_create(&level, deep, "2"));
    assert_int_equal(level_group(level)[1], DEEP - 1);
    assert_int_equal(level_group(level)[DEEP - 1], DEEP - 1);
    assert_int_equal(level_group(level)[DEEP], DEEP);
    level_destroy(level);
    assert_ok(level_create(&level, deep, "\"50000\""));
    assert_int_equal(level_group(level)[1], 50000);
    assert_int_equal(level_group(level)[50001], 50001);
    level_destroy(level);
    conus_atlas_destroy(deep);
}

TEST_GROUP(level)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_depth_cuts_the_tree),       cmocka_unit_test(a_list_takes_the_nearest),
        cmocka_unit_test(a_file_has_an_area_per_line), cmocka_unit_test(bad_levels_are_explained),
        cmocka_unit_test(every_prefix_is_answered),    cmocka_unit_test(an_atlas_without_a_tree_is_told),
        cmocka_unit_test(every_allocation_may_fail),   cmocka_unit_test(a_deep_tree_is_quick),
    };
    return cmocka_run_group_tests(tests, open_atlas, close_atlas);
}
