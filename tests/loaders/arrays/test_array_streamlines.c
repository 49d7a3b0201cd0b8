/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines from arrays: they are kept bit for bit, values out of range are refused, and a note says where they
 * hardly lie in the atlas's space. */
#include "atlas/atlas.h"
#include "test.h"

#include "conus/own.h"

#include <math.h>
#include <string.h>

/* Lengths 3 + 4 = 7, 0 and 12 mm. */
static const float floats[] = {0, 0, 0, 3, 0, 0, 3, 4, 0, 50, 60, 70, 0, 0, -5, 0, 0, 7};
static const double doubles[] = {0, 0, 0, 3, 0, 0, 3, 4, 0, 50, 60, 70, 0, 0, -5, 0, 0, 7};
static const uint64_t first[] = {0, 3, 4, 6};

static conus_polylines three_streamlines(void)
{
    conus_polylines three = CONUS_POLYLINES_INIT;
    three.points = floats;
    three.type = CONUS_SCALAR_FLOAT32;
    three.point_count = 6;
    three.first = first;
    three.streamline_count = 3;
    return three;
}

/* An atlas without voxels and areas. */
static conus_atlas *empty_atlas(void)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    return atlas;
}

/* A block of 10 x 10 x 10 voxels of 2 mm from (-10, -10, -10) to (10, 10, 10), all of them one area. */
static conus_atlas *block_atlas(void)
{
    static const double placed[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -9, -9, -9, 1};
    static uint8_t labels[1000];
    conus_atlas *atlas = NULL;
    conus_voxels voxels = CONUS_VOXELS_INIT;
    memset(labels, 1, sizeof labels);
    voxels.data = labels;
    voxels.type = CONUS_SCALAR_UINT8;
    voxels.dim[0] = voxels.dim[1] = voxels.dim[2] = 10;
    memcpy(voxels.world_from_voxel, placed, sizeof placed);
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL));
    return atlas;
}

static void check_three(const conus_tractogram_info *info)
{
    static const double low[3] = {0, 0, -5};
    static const double high[3] = {50, 60, 70};
    assert_string_equal(info->path, "array");
    assert_string_equal(info->format, "array");
    assert_string_equal(info->sha256, "");
    assert_int_equal(info->streamlines, 3);
    assert_int_equal(info->points, 6);
    assert_true(info->length_mm == 19);
    assert_false(info->half);
    assert_int_equal(info->bundle, 1);
    assert_int_equal(info->bundles, 1);
    for (int a = 0; a < 3; a++) {
        assert_true(info->low[a] == low[a] && info->high[a] == high[a]);
    }
}

static void what_is_given_is_a_bundle(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        conus_atlas *atlas = empty_atlas();
        conus_polylines three = three_streamlines();
        conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
        conus_streamlines_options options = CONUS_STREAMLINES_OPTIONS_INIT;
        options.radius = 0.25;
        three.points = kind ? (const void *)doubles : floats;
        three.type = kind ? CONUS_SCALAR_FLOAT64 : CONUS_SCALAR_FLOAT32;
        assert_ok(conus_atlas_add_polylines(atlas, &three, kind ? &options : NULL));
        assert_int_equal(conus_atlas_tractogram_count(atlas), 1);
        assert_ok(conus_atlas_tractogram(&info, atlas, 0));
        check_three(&info);
        assert_true(info.radius == (kind ? 0.25 : 0.5));
        const conus_object *bundle = conus_atlas_object(atlas, 1);
        assert_int_equal(bundle->kind, CONUS_KIND_BUNDLE);
        assert_string_equal(bundle->name, "array");
        assert_int_equal(bundle->streamlines, 3);
        assert_fails(conus_atlas_tractogram(&info, atlas, 1), CONUS_ERROR_ARGUMENT);
        assert_fails(conus_atlas_tractogram(&info, NULL, 0), CONUS_ERROR_ARGUMENT);
        conus_atlas_destroy(atlas);
    }
    assert_int_equal(conus_atlas_tractogram_count(NULL), 0);
}

/* A caller that was compiled with a struct that ends before the radius. */
static void a_smaller_struct_is_filled_as_far_as_it_goes(void **state)
{
    (void)state;
    conus_atlas *atlas = empty_atlas();
    conus_polylines three = three_streamlines();
    conus_tractogram_info info = {.struct_size = offsetof(conus_tractogram_info, radius), .radius = -1};
    assert_ok(conus_atlas_add_polylines(atlas, &three, NULL));
    assert_ok(conus_atlas_tractogram(&info, atlas, 0));
    assert_int_equal(info.points, 6);
    assert_true(info.radius == -1);
    conus_atlas_destroy(atlas);
}

static void names_come_from_options_then_from_the_path(void **state)
{
    (void)state;
    static const char *const names[][3] = {
        {NULL, NULL, "array"},        {NULL, "my/CST_left.tck", "CST_left"},
        {NULL, "a.b.TRK.gz", "a.b"},  {NULL, "folder/x.trx/", "x"},
        {NULL, "plain", "plain"},     {"Own", "a.trk", "Own"},
        {"", "tract.tt.gz", "tract"}, {NULL, ".tck", ".tck"},
        {NULL, "AF_L.vtk", "AF_L"},
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        conus_atlas *atlas = empty_atlas();
        conus_polylines three = three_streamlines();
        conus_streamlines_options options = {.name = names[i][0]};
        three.name = names[i][1];
        assert_ok(conus_atlas_add_polylines(atlas, &three, &options));
        assert_string_equal(conus_atlas_object(atlas, 1)->name, names[i][2]);
        assert_fails(conus_atlas_add_polylines(atlas, &three, &options), CONUS_ERROR_ARGUMENT);
        assert_int_equal(conus_atlas_tractogram_count(atlas), 1);
        conus_atlas_destroy(atlas);
    }
}

static void scalars_are_kept_by_name(void **state)
{
    (void)state;
    static const float points[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    static const conus_tract_scalar scalars[] = {
        {sizeof scalars[0], "pair", true, 2, points},
        {sizeof scalars[0], "weight", false, 1, points + 5},
    };
    conus_atlas *atlas = empty_atlas();
    conus_polylines three = three_streamlines();
    conus_tract_scalar scalar = CONUS_TRACT_SCALAR_INIT;
    three.scalars = scalars;
    three.scalar_count = 2;
    assert_ok(conus_atlas_add_polylines(atlas, &three, NULL));
    assert_ok(conus_atlas_tractogram_scalar(&scalar, atlas, 0, 0));
    assert_string_equal(scalar.name, "pair");
    assert_true(scalar.per_point && scalar.components == 2);
    assert_memory_equal(scalar.values, points, sizeof points);
    assert_ok(conus_atlas_tractogram_scalar(&scalar, atlas, 0, 1));
    assert_string_equal(scalar.name, "weight");
    assert_true(!scalar.per_point && scalar.components == 1);
    assert_true(scalar.values[0] == 6 && scalar.values[1] == 7 && scalar.values[2] == 8);
    assert_fails(conus_atlas_tractogram_scalar(&scalar, atlas, 0, 2), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_tractogram_scalar(&scalar, atlas, 1, 0), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
}

static void assert_refused(const conus_polylines *polylines, double radius, conus_status status, const char *message)
{
    conus_atlas *atlas = empty_atlas();
    const conus_streamlines_options options = {.radius = radius};
    assert_fails(conus_atlas_add_polylines(atlas, polylines, &options), status);
    assert_string_equal(conus_message(), message);
    assert_int_equal(conus_atlas_tractogram_count(atlas) + conus_atlas_object_count(atlas), 0);
    assert_int_equal(conus_atlas_note_count(atlas), 0);
    conus_atlas_destroy(atlas);
}

static void what_is_out_of_range_is_refused(void **state)
{
    (void)state;
    static const uint64_t back[] = {0, 4, 3, 6};
    static const float far[18] = {[7] = 2e9F};
    static const conus_tract_scalar nameless = {.components = 1, .values = floats};
    conus_polylines bad = three_streamlines();
    bad.type = CONUS_SCALAR_INT16;
    assert_refused(&bad, 0, CONUS_ERROR_ARGUMENT,
                   "array: type: 4, allowed are CONUS_SCALAR_FLOAT32 (9) and CONUS_SCALAR_FLOAT64 (10)");
    bad = three_streamlines();
    bad.points = NULL;
    assert_refused(&bad, 0, CONUS_ERROR_ARGUMENT, "array: points: NULL");
    bad = three_streamlines();
    bad.first = NULL;
    assert_refused(&bad, 0, CONUS_ERROR_ARGUMENT, "array: first: NULL");
    bad.first = back;
    assert_refused(&bad, 0, CONUS_ERROR_DATA,
                   "array: streamline 1 (from 0): begins at point 4 and ends before point 3");
    bad = three_streamlines();
    bad.points = far;
    assert_refused(
        &bad, 0, CONUS_ERROR_DATA,
        "array: point 2 of streamline 0 (both from 0): found (0, 2000000000, 0) mm, allowed is within 1e9 of "
        "0");
    bad = three_streamlines();
    assert_refused(&bad, -1, CONUS_ERROR_ARGUMENT, "array: radius -1 mm, allowed is above 0 to 100");
    assert_refused(&bad, (double)NAN, CONUS_ERROR_ARGUMENT, "array: radius nan mm, allowed is above 0 to 100");
    assert_refused(&bad, 101, CONUS_ERROR_ARGUMENT, "array: radius 101 mm, allowed is above 0 to 100");
    bad.scalar_count = 1;
    assert_refused(&bad, 0, CONUS_ERROR_ARGUMENT, "array: scalars: NULL");
    bad.scalars = &nameless;
    assert_refused(&bad, 0, CONUS_ERROR_ARGUMENT,
                   "array: scalar 0: a name, 1 or more components and values are needed");
    assert_fails(conus_atlas_add_polylines(NULL, &bad, NULL), CONUS_ERROR_ARGUMENT);
}

static conus_status try_adding(void *data)
{
    static const conus_tract_scalar weight = {.name = "weight", .components = 1, .values = floats};
    conus_polylines three = three_streamlines();
    three.scalars = &weight;
    three.scalar_count = 1;
    conus_atlas *atlas = data;
    size_t before = conus_atlas_object_count(atlas);
    size_t notes = conus_atlas_note_count(atlas);
    conus_status status = conus_atlas_add_polylines(atlas, &three, NULL);
    if (status) {
        assert_int_equal(conus_atlas_object_count(atlas), before);
        assert_int_equal(conus_atlas_note_count(atlas), notes);
    }
    return status;
}

static void a_failing_allocation_changes_nothing(void **state)
{
    (void)state;
    conus_atlas *atlas = block_atlas();
    test_every_allocation(try_adding, atlas);
    assert_int_equal(conus_atlas_tractogram_count(atlas), 1);
    conus_atlas_destroy(atlas);
}

/* Adds one streamline of so many points. */
static void assert_line_note(conus_atlas *atlas, const float *points, size_t count, const char *note)
{
    const uint64_t ends[] = {0, count};
    conus_polylines line = three_streamlines();
    line.points = points;
    line.point_count = count;
    line.first = ends;
    line.streamline_count = 1;
    line.name = "line";
    size_t before = conus_atlas_note_count(atlas);
    assert_ok(conus_atlas_add_polylines(atlas, &line, NULL));
    assert_int_equal(conus_atlas_note_count(atlas) - before, note != NULL);
    if (note) {
        assert_string_equal(conus_atlas_note(atlas, before), note);
    }
}

static void assert_note(const float points[9], const char *note)
{
    conus_atlas *atlas = block_atlas();
    assert_line_note(atlas, points, 3, note);
    conus_atlas_destroy(atlas);
}

/* The areas are from -10 to 10 mm. Index 5 is at 1 mm, 9 at 9 mm: (9, 9, 9), (9, 5, 0) and (0, 0, 9) are in the box
 * both as mm and as indices, so they may be either; -1 is no index; 12 is beyond the grid. */
static void another_space_is_noted(void **state)
{
    (void)state;
    assert_note((const float[]){-1, 0, 0, 9, 9, 9, 9, -9, 5}, NULL);
    assert_note((const float[]){-1, 0, 0, 9, 9, 9, 12, 0, 0}, NULL);
    assert_note((const float[]){-1, 0, 0, 11, 9, 9, 12, 0, 0},
                "bundle line: 33.3 % of its points are in the box around the areas: is it in their space?");
    assert_note((const float[]){-11, 0, 0, 11, 9, 9, 12, 0, 0},
                "bundle line: none of 3 points is in the box around the areas: is it in their space?");
    assert_note(
        (const float[]){9, 9, 9, 9, 5, 0, 0, 0, 9},
        "bundle line: all coordinates are from 0 to the 10 x 10 x 10 voxels of the atlas, and areas reach below "
        "0 mm: are they voxel indices, not mm?");
    /* as an index, 10 is at 11 mm, out of the box; as mm it is on its border */
    assert_note((const float[]){10, 9, 9, 9, 5, 0, 0, 0, 9}, NULL);
}

/* The grid of the atlas is 20 mm wide: 5 m are 250 times as much. */
static void another_unit_is_noted(void **state)
{
    (void)state;
    assert_note((const float[]){-1, 0, 0, 0, 0, 0, 4998, 0, 0}, NULL);
    assert_note((const float[]){-1, 0, 0, 0, 0, 0, 4999, 0, 0},
                "bundle line: 5000 mm long, beside areas of 20 mm: is one of the two in micrometres, not mm?");
    assert_note((const float[]){0, 0, 0, 0.07F, 0, 0, 0.07F, 0.01F, 0},
                "bundle line: 0.07 mm long, beside areas of 20 mm: is one of the two in metres, not mm?");
}

/* The atlas is moved by 30 mm along x: its areas were from -10 to 10 and are from 20 to 40 mm. One of 20 points is a
 * twentieth of them. */
static void what_lay_better_before_a_move_is_noted(void **state)
{
    static const double back[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -30, 0, 0, 1};
    static const struct {
        float first, others; /* x of the points */
        const char *note;
    } cases[] = {
        {0, 30, NULL},
        {30, 0,
         "bundle line: 5 % of its points are in the box around the areas, 95 % were before these were moved: if it is "
         "in the atlas's space, let it move, too (,moves behind the file)"},
        {0, 15,
         "bundle line: 0 % of its points are in the box around the areas, 5 % were before these were moved: if it is "
         "in the atlas's space, let it move, too (,moves behind the file)"},
        {15, 15, "bundle line: none of 20 points is in the box around the areas: is it in their space?"},
        {15, 30, NULL},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_atlas *atlas = block_atlas();
        assert_ok(conus_atlas_move(atlas, back));
        float points[60] = {cases[i].first};
        for (size_t k = 1; k < 20; k++) {
            points[3 * k] = cases[i].others;
        }
        assert_line_note(atlas, points, 20, cases[i].note);
        conus_atlas_destroy(atlas);
    }
}

TEST_GROUP(array_streamlines)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_given_is_a_bundle),
        cmocka_unit_test(a_smaller_struct_is_filled_as_far_as_it_goes),
        cmocka_unit_test(names_come_from_options_then_from_the_path),
        cmocka_unit_test(scalars_are_kept_by_name),
        cmocka_unit_test(what_is_out_of_range_is_refused),
        cmocka_unit_test(a_failing_allocation_changes_nothing),
        cmocka_unit_test(another_space_is_noted),
        cmocka_unit_test(another_unit_is_noted),
        cmocka_unit_test(what_lay_better_before_a_move_is_noted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
