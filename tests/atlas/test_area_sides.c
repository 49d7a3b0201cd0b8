/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_sides(): left and right areas by table, pair, name and tree. */
#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

static const size_t dim[3] = {8, 2, 1};
static const uint32_t labels[16] = {1, 1, 1, 2, 1, 2, 2, 2, 3, 3, 3, 3, 4, 4, 0, 0};

/* The side of each object, '-' for none; object 0, which stands for no object, is left out. */
static const char *sides_of(const conus_atlas *atlas)
{
    static char text[64];
    char sides[64];
    size_t count = conus_atlas_object_count(atlas);
    memset(sides, 'x', sizeof sides);
    assert_ok(conus_atlas_sides(sides, atlas));
    assert_int_equal(sides[0], 0);
    assert_int_equal(sides[count + 1], 'x');
    for (size_t number = 1; number <= count; number++) {
        text[number - 1] = (char)(sides[number] ? sides[number] : '-');
    }
    text[count] = '\0';
    return text;
}

static const char *sides_of_rows(const struct area_row *rows)
{
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    const char *text = sides_of(atlas);
    conus_atlas_destroy(atlas);
    return text;
}

/* Voxels have labels 1 to 4, so there are four areas, followed by those that only group others, by label. */
static void each_way_of_saying_it_counts(void **state)
{
    (void)state;
    /* the table comes before the name; B is no side */
    assert_string_equal(sides_of_rows((const struct area_row[]){
                            {1, "A", 0, NULL, 'L'}, {2, "A left", 0, NULL, 'R'}, {3, "A right", 0, NULL, 'B'}, {0}}),
                        "LR--");
    /* a letter needs its counterpart, a word does not */
    assert_string_equal(
        sides_of_rows((const struct area_row[]){
            {1, "A_L", 0, NULL, 0}, {2, "A_R", 0, NULL, 0}, {3, "B_R", 0, NULL, 0}, {4, "rh.C", 0, NULL, 0}, {0}}),
        "LR-R");
    /* the tree: the nearest ancestor with a side counts, and B ends the search */
    assert_string_equal(sides_of_rows((const struct area_row[]){{1, "A", 9, NULL, 0},
                                                                {2, "B", 8, NULL, 0},
                                                                {3, "C left", 8, NULL, 0},
                                                                {4, "D", 7, NULL, 0},
                                                                {7, "Middle", 8, NULL, 'B'},
                                                                {8, "Right brain", 0, NULL, 0},
                                                                {9, "Left brain", 0, NULL, 0},
                                                                {0}}),
                        "LRL--RL");
}

/* Halves have sides, whatever their names were. The areas of a merged pair keep theirs; the pair has none, nor has a
 * pathway. */
static void split_and_merged_areas_have_sides(void **state)
{
    static const struct area_row rows[] = {
        {1, "A", 0, NULL, 0}, {2, "B", 0, NULL, 0}, {3, "C_L", 0, NULL, 0}, {4, "C_R", 0, NULL, 0}, {0}};
    conus_atlas *atlas = NULL;
    (void)state;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(area_rows_add_pathway(atlas, "CST left"));
    assert_string_equal(sides_of(atlas), "--LR-");
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT)); /* A has one of four voxels at x > 0 */
    assert_string_equal(sides_of(atlas), "LRLLRR-");
    conus_atlas_destroy(atlas);
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED));
    assert_string_equal(sides_of(atlas), "--LR-");
    conus_atlas_destroy(atlas);
}

static void nothing_is_written_without_memory(void **state)
{
    static const struct area_row rows[] = {{1, "A_L", 0, NULL, 0}, {2, "A_R", 0, NULL, 0}, {0}};
    conus_atlas *atlas = NULL;
    conus_status status = CONUS_ERROR_MEMORY;
    (void)state;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    for (long allowed = 0; status; allowed++) {
        char sides[5] = {'x', 'x', 'x', 'x', 'x'};
        test_fail_allocation(allowed);
        status = conus_atlas_sides(sides, atlas);
        test_fail_allocation(-1);
        assert_true(status == CONUS_OK || status == CONUS_ERROR_MEMORY);
        assert_memory_equal(sides, status ? "xxxxx" : "\0LR\0\0", sizeof sides);
        assert_true(allowed < 100);
    }
    conus_atlas_destroy(atlas);
}

/* AAL has 54 pairs of areas and 8 parts of the vermis, which have no side. */
static void aal_has_two_sides(void **state)
{
    conus_atlas *atlas = NULL;
    size_t counts[3] = {0};
    (void)state;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    char *sides = malloc(conus_atlas_object_count(atlas) + 1);
    assert_ok(conus_atlas_sides(sides, atlas));
    for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        const char *name = conus_atlas_object(atlas, number)->name;
        counts[sides[number] == 'L' ? 0 : sides[number] == 'R' ? 1 : 2]++;
        assert_int_equal(sides[number] != 0, strncmp(name, "Vermis", 6) != 0);
        assert_true(!sides[number] || name[strlen(name) - 1] == sides[number]);
    }
    assert_int_equal(counts[0], 54);
    assert_int_equal(counts[1], 54);
    assert_int_equal(counts[2], 8);
    free(sides);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(area_sides)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_way_of_saying_it_counts),
        cmocka_unit_test(split_and_merged_areas_have_sides),
        cmocka_unit_test(nothing_is_written_without_memory),
        cmocka_unit_test(aal_has_two_sides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
