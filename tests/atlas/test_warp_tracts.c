/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines moved by a deformation field whose inverse is known in closed form. A streamline with a point that has no
 * place is left out whole, with its numbers and its places in groups. */
#include "atlas/atlas.h"
#include "atlas/warp/warp.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <string.h>

enum { NX = 11, NY = 13, NZ = 15, NODES = NX * NY * NZ, STREAMLINES = 4, POINTS = 9 };

/* Nodes 2 mm apart from (-10, -12, -14) on; the displacement (0.25 x + 0.5 y + 1, -0.25 z, 3) is exact between them. */
static struct deformation make_field(bool stays_outside)
{
    struct deformation field = {.dim = {NX, NY, NZ}, .stays_outside = stays_outside};
    field.vectors = memory_raw((size_t)3 * NODES, sizeof *field.vectors);
    mat4_identity(field.world_from_voxel);
    for (int a = 0; a < 3; a++) {
        field.world_from_voxel[5 * a] = 2;
        field.world_from_voxel[12 + a] = -10 - 2 * a;
    }
    assert_true(mat4_invert_affine(field.voxel_from_world, field.world_from_voxel));
    memcpy(field.base, field.world_from_voxel, sizeof field.base);
    mat4_identity(field.linear);
    for (int n = 0; n < NODES; n++) {
        const int at[3] = {n % NX, n / NX % NY, n / (NX * NY)};
        double p[3] = {at[0], at[1], at[2]};
        mat4_point(p, field.world_from_voxel, p);
        field.vectors[3 * n] = (float)(0.25 * p[0] + 0.5 * p[1] + 1);
        field.vectors[3 * n + 1] = (float)(-0.25 * p[2]);
        field.vectors[3 * n + 2] = 3;
    }
    assert_ok(deformation_measure(&field));
    return field;
}

/* The point that the field moves to (x, y, z): the inverse of x' = 1.25 x + 0.5 y + 1, y' = y - 0.25 z, z' = z + 3. */
static void way_back(double out[3], const double p[3])
{
    out[2] = p[2] - 3;
    out[1] = p[1] + 0.25 * out[2];
    out[0] = (p[0] - 1 - 0.5 * out[1]) / 1.25;
}

static double distance(const double a[3], const double b[3])
{
    double way[3];
    vec3_sub(way, a, b);
    return vec3_length(way);
}

/* No point of the grid goes to x = 400. */
static const float near_points[3 * POINTS] = {0, 0, 0, 3, 0, 0, 3, 4, 0, 1, 1,  1, 2, 2,
                                              2, 0, 0, 3, 0, 5, 3, 5, 5, 3, -4, 2, 6};
static const uint64_t first[STREAMLINES + 1] = {0, 3, 5, 5, 9};

static struct tractogram make_tractogram(void)
{
    static const uint32_t members[] = {0, 1, 3};
    struct tractogram made = tract_of("t.trk", near_points, first, STREAMLINES, 0.5);
    made.scalars = memory_zeroed(2, sizeof *made.scalars);
    made.scalar_count = 2;
    made.scalars[0] = (struct tract_scalar){
        .name = memory_text("at", 2), .per_point = true, .components = 2, .values = memory_raw(POINTS, 8)};
    made.scalars[1] =
        (struct tract_scalar){.name = memory_text("k", 1), .components = 1, .values = memory_raw(STREAMLINES, 4)};
    for (int i = 0; i < 2 * POINTS; i++) {
        made.scalars[0].values[i] = (float)i;
    }
    for (int k = 0; k < STREAMLINES; k++) {
        made.scalars[1].values[k] = (float)k;
    }
    tract_add_group(&made, "some", members, 3);
    return made;
}

static conus_atlas *make_atlas(struct tractogram *tractogram)
{
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, tractogram, "rest"));
    return atlas;
}

static const conus_volume_info grid = {.dim = {2, 2, 2}, .spacing = {1, 1, 1}};
static const struct warp_plan plan = {.words = "field.nii", .grid = &grid};

/* Whether a note of the atlas says this. */
static bool says(const conus_atlas *atlas, const char *note)
{
    bool found = false;
    for (size_t i = 0; i < atlas->notes.count; i++) {
        found = found || strcmp(atlas->notes.lines[i], note) == 0;
    }
    return found;
}

/* Asserts that point `index` of the atlas is the point that the field moves to `given`. */
static void assert_went_back(const conus_atlas *atlas, uint64_t index, const float given[3])
{
    double expected[3];
    double p[3];
    way_back(expected, (const double[]){(double)given[0], (double)given[1], (double)given[2]});
    tractogram_point(p, &atlas->tractograms[0], index);
    assert_true(distance(p, expected) < 4e-6); /* 1e-6 of the search, then rounded to float below 16 mm */
}

static void points_go_back_through_the_field(void **state)
{
    (void)state;
    struct tractogram tractogram = make_tractogram();
    conus_atlas *atlas = make_atlas(&tractogram);
    struct deformation field = make_field(false);
    const uint64_t *kept = atlas->tractograms[0].first;
    assert_ok(atlas_warp(atlas, &field, 1, &plan));
    for (uint64_t i = 0; i < POINTS; i++) {
        assert_went_back(atlas, i, &near_points[3 * i]);
    }
    assert_ptr_equal(atlas->tractograms[0].first, kept);
    double ends[2][3];
    way_back(ends[0], (const double[]){1, 1, 1});
    way_back(ends[1], (const double[]){2, 2, 2});
    double length = tractogram_length(&atlas->tractograms[0], 1);
    assert_true(fabs(length - distance(ends[0], ends[1])) < 8e-6);
    assert_int_equal(atlas->objects[0].streamlines, 3);
    assert_false(says(atlas, "field.nii: 1 of 4 streamlines are left out, with a point that has no place"));
    conus_atlas_destroy(atlas);
}

/* Streamline 1 has a point to which no point of the grid goes. */
static void a_streamline_with_a_lost_point_is_left_out(void **state)
{
    (void)state;
    struct tractogram tractogram = make_tractogram();
    tractogram.points[3 * 4] = 400;
    conus_atlas *atlas = make_atlas(&tractogram);
    struct deformation field = make_field(false);
    assert_ok(atlas_warp(atlas, &field, 1, &plan));
    const struct tractogram *moved = &atlas->tractograms[0];
    static const uint64_t shorter[] = {0, 3, 3, 7};
    assert_int_equal(moved->streamline_count, 3);
    assert_int_equal(moved->point_count, 7);
    assert_memory_equal(moved->first, shorter, sizeof shorter);
    for (uint64_t i = 0; i < 7; i++) {
        uint64_t before = i < 3 ? i : i + 2;
        assert_went_back(atlas, i, &near_points[3 * before]);
        assert_true(moved->scalars[0].values[2 * i] == (float)(2 * before));
        assert_true(moved->scalars[0].values[2 * i + 1] == (float)(2 * before + 1));
    }
    static const float numbers[] = {0, 2, 3};
    static const uint32_t members[] = {0, 2};
    assert_memory_equal(moved->scalars[1].values, numbers, sizeof numbers);
    assert_string_equal(moved->scalars[1].name, "k");
    assert_int_equal(moved->groups[0].count, 2);
    assert_memory_equal(moved->groups[0].members, members, sizeof members);
    assert_int_equal(moved->groups[1].count, 1); /* the rest: the streamline without a point */
    assert_int_equal(moved->groups[1].members[0], 1);
    assert_string_equal(moved->path, "t.trk");
    assert_true(moved->radius == 0.5);
    assert_int_equal(atlas->objects[0].streamlines, 2);
    assert_int_equal(atlas->objects[0].points, 7);
    assert_true(says(atlas, "field.nii: 1 of 9 points of streamlines lie outside of the field"));
    assert_true(says(atlas, "field.nii: 1 of 4 streamlines are left out, with a point that has no place"));
    assert_ok(tractogram_check_tree(moved));
    conus_atlas_destroy(atlas);
}

/* ANTs leaves points outside of the field's grid where they are. */
static void points_outside_of_a_field_of_ants_stay(void **state)
{
    (void)state;
    struct tractogram tractogram = make_tractogram();
    tractogram.points[3 * 4] = 400;
    conus_atlas *atlas = make_atlas(&tractogram);
    struct deformation field = make_field(true);
    assert_ok(atlas_warp(atlas, &field, 1, &plan));
    const float *stayed = atlas->tractograms[0].points + 12;
    assert_int_equal(atlas->tractograms[0].streamline_count, 4);
    assert_true(stayed[0] == 400 && stayed[1] == 2 && stayed[2] == 2);
    assert_true(says(atlas,
                     "field.nii: 1 of 9 points of streamlines lie outside of the field; those outside of its grid "
                     "stay where they are"));
    conus_atlas_destroy(atlas);
}

static void an_atlas_that_would_be_empty_is_unchanged(void **state)
{
    (void)state;
    struct tractogram tractogram = make_tractogram();
    for (int i = 0; i < POINTS; i++) {
        tractogram.points[3 * i] += 400;
    }
    tractogram.first[2] = 4; /* and none without a point */
    conus_atlas *atlas = make_atlas(&tractogram);
    struct deformation field = make_field(false);
    assert_fails(atlas_warp(atlas, &field, 1, &plan), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "t.trk: no streamline is where the field leads to");
    assert_true(atlas->tractograms[0].points[0] == 400);
    assert_int_equal(atlas->tractograms[0].streamline_count, STREAMLINES);
    assert_int_equal(atlas->notes.count, 0);
    deformation_finish(&field);
    conus_atlas_destroy(atlas);
}

struct attempt {
    conus_atlas *atlas;
    struct deformation field;
};

static conus_status try_warping(void *data)
{
    struct attempt *attempt = data;
    conus_status status = atlas_warp(attempt->atlas, &attempt->field, 1, &plan);
    if (status) {
        assert_int_equal(attempt->atlas->tractograms[0].streamline_count, STREAMLINES);
        assert_int_equal(attempt->atlas->notes.count, 0);
    }
    return status;
}

static void a_failing_allocation_changes_nothing(void **state)
{
    (void)state;
    struct tractogram tractogram = make_tractogram();
    tractogram.points[3 * 4] = 400;
    struct attempt attempt = {make_atlas(&tractogram), make_field(false)};
    test_every_allocation(try_warping, &attempt);
    assert_int_equal(attempt.atlas->tractograms[0].streamline_count, STREAMLINES - 1);
    conus_atlas_destroy(attempt.atlas);
}

TEST_GROUP(warp_tracts)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_go_back_through_the_field),
        cmocka_unit_test(a_streamline_with_a_lost_point_is_left_out),
        cmocka_unit_test(points_outside_of_a_field_of_ants_stay),
        cmocka_unit_test(an_atlas_that_would_be_empty_is_unchanged),
        cmocka_unit_test(a_failing_allocation_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
