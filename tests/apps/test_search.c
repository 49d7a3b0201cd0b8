/* SPDX-License-Identifier: BSD-3-Clause */
/* The order of areas that a search finds. */
#include "viewer/model/viewer.h"

#include "conus/arrays.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

static conus_atlas *make_atlas(void)
{
    static const conus_label labels[] = {{.number = 4, .name = "Area 44"},
                                         {.number = 7, .name = "Area 4"},
                                         {.number = 9, .name = "4"},
                                         {.number = 12, .name = "V14", .abbreviation = "OCC"},
                                         {.number = 20, .name = "Superior_Occipital"},
                                         {.number = 21, .name = "occipital pole"},
                                         {.number = 22, .name = "Occipital Pole"},
                                         {.number = 44, .name = "Precentral"},
                                         {.number = 50, .name = "S\xc3\xa9nile"},
                                         {.number = 51, .name = "Hippocampus_L"},
                                         {.number = 52, .name = "Hippocampus_R"}};
    enum { COUNT = sizeof labels / sizeof labels[0] };
    uint8_t data[COUNT];
    conus_atlas *atlas = NULL;
    for (size_t i = 0; i < COUNT; i++) {
        data[i] = (uint8_t)labels[i].number;
    }
    const conus_voxels voxels = {.data = data,
                                 .type = CONUS_SCALAR_UINT8,
                                 .dim = {COUNT, 1, 1},
                                 .world_from_voxel = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    assert_ok(conus_atlas_create(&atlas, &voxels, labels, COUNT, NULL));
    return atlas;
}

/* @p wanted are labels, ended by 0. */
static void assert_found(const conus_atlas *atlas, const char *text, const uint32_t *wanted)
{
    size_t count;
    uint32_t *found = search_all(&count, atlas, text);
    assert_non_null(found);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(conus_atlas_object(atlas, found[i])->label, wanted[i]);
    }
    assert_int_equal(wanted[count], 0);
    assert_int_equal(search_best(atlas, text), count ? found[0] : 0);
    free(found);
}

/* By hand: first a whole name, then a beginning, then the beginning of a word, then anywhere, then the label. */
static void names_come_before_numbers(void **state)
{
    conus_atlas *atlas = make_atlas();
    (void)state;
    assert_found(atlas, "4", (const uint32_t[]){9, 4, 7, 12, 0});
    assert_found(atlas, "44", (const uint32_t[]){4, 44, 0});
    assert_found(atlas, "area 4", (const uint32_t[]){7, 4, 0});
    assert_found(atlas, "7", (const uint32_t[]){7, 0});
    assert_found(atlas, "07", (const uint32_t[]){0});
    conus_atlas_destroy(atlas);
}

static void whole_names_come_before_parts(void **state)
{
    conus_atlas *atlas = make_atlas();
    (void)state;
    assert_found(atlas, "occ", (const uint32_t[]){12, 21, 22, 20, 0}); /* V14 is abbreviated so */
    assert_found(atlas, "Occipital Pole", (const uint32_t[]){22, 21, 0});
    assert_found(atlas, "pole", (const uint32_t[]){21, 22, 0});
    assert_found(atlas, "ipital", (const uint32_t[]){20, 21, 22, 0});
    assert_int_equal(search_fit(conus_atlas_object(atlas, search_best(atlas, "nile")), "nile"), SEARCH_PART);
    conus_atlas_destroy(atlas);
}

/* Other words that the command line takes for one name: another order, a side in full, blanks. */
static void words_mean_what_they_mean_elsewhere(void **state)
{
    conus_atlas *atlas = make_atlas();
    (void)state;
    assert_found(atlas, "left hippocampus", (const uint32_t[]){51, 0});
    assert_found(atlas, "hippocampus right", (const uint32_t[]){52, 0});
    assert_found(atlas, "superior occipital", (const uint32_t[]){20, 0});
    assert_found(atlas, "hippocampus", (const uint32_t[]){51, 52, 0}); /* no side is chosen */
    conus_atlas_destroy(atlas);
}

static void nothing_fits_nothing(void **state)
{
    conus_atlas *atlas = make_atlas();
    (void)state;
    assert_found(atlas, "", (const uint32_t[]){0});
    assert_found(atlas, "cerebellum", (const uint32_t[]){0});
    conus_atlas_destroy(atlas);
}

TEST_GROUP(search)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_come_before_numbers),
        cmocka_unit_test(whole_names_come_before_parts),
        cmocka_unit_test(words_mean_what_they_mean_elsewhere),
        cmocka_unit_test(nothing_fits_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
