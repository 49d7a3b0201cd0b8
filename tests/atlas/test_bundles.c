/* SPDX-License-Identifier: BSD-3-Clause */
/* Tractograms become bundles: their numbers, names, groups, moves and hiding. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "test.h"
#include "tract_scene.h"

#include <string.h>

/* Three streamlines: two steps of 3 and 4 mm along x and y, a single point, one step along z. Lengths 7, 0 and 12
 * mm. */
static const float corners[] = {0, 0, 0, 3, 0, 0, 3, 4, 0, 50, 60, 70, 0, 0, -5, 0, 0, 7};
static const uint64_t first[] = {0, 3, 4, 6};

static struct tractogram three_streamlines(void)
{
    return tract_of("three.tck", corners, first, 3, 0.5);
}

static conus_atlas *empty_atlas(void)
{
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    return atlas;
}

static void test_without_groups_all_streamlines_are_one_bundle(void **state)
{
    (void)state;
    conus_atlas *atlas = empty_atlas();
    struct tractogram tractogram = three_streamlines();
    assert_ok(atlas_add_tractogram(atlas, &tractogram, "three"));
    assert_null(tractogram.points);
    const conus_object *bundle = conus_atlas_object(atlas, 1);
    assert_int_equal(bundle->kind, CONUS_KIND_BUNDLE);
    assert_int_equal(bundle->label, 1);
    assert_string_equal(bundle->name, "three");
    assert_int_equal(bundle->streamlines, 3);
    assert_int_equal(bundle->points, 6);
    assert_true(bundle->length_mm == 19);
    assert_true(bundle->radius == 0.5);
    assert_null(atlas_bundle_group(atlas, 1));
    assert_ptr_equal(atlas_bundle_tractogram(atlas, 1), &atlas->tractograms[0]);
    assert_null(atlas_object_volume(atlas, 1));
    conus_atlas_destroy(atlas);
}

static void test_groups_are_bundles_and_what_is_in_none_is_the_last(void **state)
{
    (void)state;
    static const uint32_t ends[] = {0, 2};
    static const uint32_t last[] = {2};
    conus_atlas *atlas = empty_atlas();
    struct tractogram tractogram = three_streamlines();
    tract_add_group(&tractogram, "ends", ends, 2);
    tract_add_group(&tractogram, "last", last, 1);
    assert_ok(atlas_add_tractogram(atlas, &tractogram, "rest"));
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    static const char *const names[] = {"ends", "last", "rest"};
    static const double lengths[] = {19, 12, 0};
    for (size_t i = 0; i < 3; i++) {
        const conus_object *bundle = conus_atlas_object(atlas, i + 1);
        assert_string_equal(bundle->name, names[i]);
        assert_true(bundle->length_mm == lengths[i]);
        assert_int_equal(bundle->label, i + 1);
    }
    assert_int_equal(atlas_bundle_group(atlas, 3)->count, 1);
    assert_int_equal(atlas_bundle_group(atlas, 3)->members[0], 1);
    conus_atlas_destroy(atlas);
}

static void test_two_bundles_of_one_name_are_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = empty_atlas();
    struct tractogram one = three_streamlines();
    struct tractogram two = three_streamlines();
    assert_ok(atlas_add_tractogram(atlas, &one, "three"));
    assert_fails(atlas_add_tractogram(atlas, &two, "three"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(),
                        "three.tck: bundle three: another bundle has that name; name= gives it one of its own");
    assert_int_equal(conus_atlas_object_count(atlas), 1);
    tractogram_finish(&two);
    conus_atlas_destroy(atlas);
}

/* The second file has a group of the same name, which becomes "two ends"; the rest of its streamlines is "two". */
static void test_groups_of_one_name_are_told_apart_by_their_tractogram(void **state)
{
    (void)state;
    static const uint32_t ends[] = {0, 2};
    static const char *const names[] = {"ends", "one", "two ends", "two"};
    conus_atlas *atlas = empty_atlas();
    struct tractogram one = three_streamlines();
    struct tractogram two = three_streamlines();
    struct tractogram again = three_streamlines();
    tract_add_group(&one, "ends", ends, 2);
    tract_add_group(&two, "ends", ends, 2);
    tract_add_group(&again, "other", ends, 2);
    assert_ok(atlas_add_tractogram(atlas, &one, "one"));
    assert_int_equal(conus_atlas_note_count(atlas), 0);
    assert_ok(atlas_add_tractogram(atlas, &two, "two"));
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(conus_atlas_object(atlas, i + 1)->name, names[i]);
    }
    assert_string_equal(conus_atlas_note(atlas, 0), "three.tck: group ends: the bundle is called two ends, since "
                                                    "another bundle has that name");
    assert_fails(atlas_add_tractogram(atlas, &again, "two"), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(),
                        "three.tck: bundle two: another bundle has that name; name= gives it one of its own");
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    assert_int_equal(conus_atlas_note_count(atlas), 1);
    tractogram_finish(&again);
    conus_atlas_destroy(atlas);
}

static void test_bounds_hold_the_radius_and_the_centre_is_the_mean_of_points(void **state)
{
    (void)state;
    static const double expected[2][3] = {{-0.5, -0.5, -5.5}, {50.5, 60.5, 70.5}};
    static const double centre[3] = {56.0 / 6, 64.0 / 6, 72.0 / 6};
    conus_atlas *atlas = empty_atlas();
    struct tractogram tractogram = three_streamlines();
    double low[3];
    double high[3];
    double middle[3];
    assert_ok(atlas_add_tractogram(atlas, &tractogram, "three"));
    assert_ok(conus_atlas_bounds(low, high, atlas));
    assert_ok(conus_atlas_centre(middle, atlas, 1));
    for (int a = 0; a < 3; a++) {
        assert_true(low[a] == expected[0][a] && high[a] == expected[1][a]);
        assert_true(fabs(middle[a] - centre[a]) < 1e-12);
    }
    conus_atlas_destroy(atlas);
}

/* Twice as large and 10 mm along x: lengths double; the radius is in mm of the poses and stays. */
static void test_a_move_takes_points_along_and_measures_anew(void **state)
{
    (void)state;
    static const double atlas_from_world[16] = {0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, -5, 0, 0, 1};
    conus_atlas *atlas = empty_atlas();
    struct tractogram tractogram = three_streamlines();
    double p[3];
    assert_ok(atlas_add_tractogram(atlas, &tractogram, "three"));
    assert_ok(conus_atlas_move(atlas, atlas_from_world));
    tractogram_point(p, &atlas->tractograms[0], 2);
    assert_true(p[0] == 16 && p[1] == 8 && p[2] == 0);
    assert_true(conus_atlas_object(atlas, 1)->length_mm == 38);
    assert_true(conus_atlas_object(atlas, 1)->radius == 0.5);
    conus_atlas_destroy(atlas);
}

static void test_a_bundle_is_hidden_by_its_name(void **state)
{
    (void)state;
    static const uint32_t ends[] = {0, 2};
    conus_atlas *atlas = empty_atlas();
    struct buffer hidden = {0};
    struct tractogram tractogram = three_streamlines();
    tract_add_group(&tractogram, "ends", ends, 2);
    assert_ok(atlas_add_tractogram(atlas, &tractogram, "rest"));
    assert_true(atlas_has_bundles(atlas));
    assert_ok(conus_atlas_show(atlas, NULL, "rest"));
    atlas_list_hidden(&hidden, atlas);
    assert_string_equal(hidden.data, "bundles 2");
    assert_true(atlas_has_bundles(atlas));
    buffer_finish(&hidden);
    conus_atlas_destroy(atlas);
}

/* Three streamlines, of which two are the group "ends". */
static conus_status add_three(conus_atlas *atlas, const char *name)
{
    static const uint32_t ends[] = {0, 2};
    struct tractogram tractogram = {0};
    tractogram.path = memory_text("a", 1);
    tractogram.points = memory_copy(corners, 18, sizeof *corners);
    tractogram.first = memory_copy(first, 4, sizeof *first);
    tractogram.groups = memory_zeroed(1, sizeof *tractogram.groups);
    bool whole = tractogram.path && tractogram.points && tractogram.first && tractogram.groups;
    if (whole) {
        tractogram.group_count = 1;
        tractogram.groups[0].name = memory_text("ends", 4);
        tractogram.groups[0].members = memory_copy(ends, 2, sizeof *ends);
        tractogram.groups[0].count = 2;
        whole = tractogram.groups[0].name && tractogram.groups[0].members;
    }
    tractogram.point_count = 6;
    tractogram.streamline_count = 3;
    tractogram.radius = 0.5;
    conus_status status = whole ? atlas_add_tractogram(atlas, &tractogram, name) : CONUS_ERROR_MEMORY;
    tractogram_finish(&tractogram);
    return status;
}

static conus_status add_and_move(void *user)
{
    (void)user;
    static const double turn[16] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    conus_atlas *atlas = NULL;
    conus_status status = atlas_create_empty(&atlas, "none");
    status = status ? status : add_three(atlas, "rest");
    status = status ? status : add_three(atlas, "more"); /* its group is called "more ends" */
    status = status ? status : conus_atlas_move(atlas, turn);
    conus_atlas_destroy(atlas);
    return status;
}

static void test_every_failing_allocation_is_reported(void **state)
{
    (void)state;
    test_every_allocation(add_and_move, NULL);
}

TEST_GROUP(bundles)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_without_groups_all_streamlines_are_one_bundle),
        cmocka_unit_test(test_groups_are_bundles_and_what_is_in_none_is_the_last),
        cmocka_unit_test(test_two_bundles_of_one_name_are_refused),
        cmocka_unit_test(test_groups_of_one_name_are_told_apart_by_their_tractogram),
        cmocka_unit_test(test_bounds_hold_the_radius_and_the_centre_is_the_mean_of_points),
        cmocka_unit_test(test_a_move_takes_points_along_and_measures_anew),
        cmocka_unit_test(test_a_bundle_is_hidden_by_its_name),
        cmocka_unit_test(test_every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
