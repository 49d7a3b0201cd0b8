/* SPDX-License-Identifier: BSD-3-Clause */
/* The order of results (Eq. 12): ties, the box that `nearness` uses, the rim that `smallest` uses. Values are derived
 * here: by hand on small grids, or by trying every voxel. */
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "scene.h"
#include "selection/measure/score.h"
#include "test.h"
#include "value_maps.h"

#include <stdio.h>
#include <string.h>

enum { TIED = 5 };

/* Asserts the order of two rows that differ in all that decides, so that only the first difference may count. */
static void assert_first(const conus_result *first, const conus_result *second)
{
    for (int swapped = 0; swapped < 2; swapped++) {
        conus_result rows[] = {swapped ? *second : *first, swapped ? *first : *second, {.object = 0}};
        struct statistics statistics = {rows, 3};
        struct ranking ranking;
        const struct score_view view = {.cone_pixels = 1};
        assert_ok(ranking_parse(&ranking, "visibility"));
        score_rank(&statistics, &ranking, &view);
        assert_int_equal(rows[0].object, first->object);
        assert_int_equal(rows[1].object, second->object);
        assert_int_equal(rows[0].rank, 1);
        assert_int_equal(rows[1].rank, 2);
        assert_int_equal(rows[2].object, 0);
    }
}

static void ties_go_by_share_distance_entry_and_number(void **state)
{
    (void)state;
    /* In the order of the criteria: every row is better in one of them and worse in all that follow. */
    const conus_result best[TIED] = {
        {.object = 9, .pixels = 2, .share = 0.1, .distance = 50, .entry = 50},
        {.object = 9, .pixels = 1, .share = 0.2, .distance = 50, .entry = 50},
        {.object = 9, .pixels = 1, .share = 0.1, .distance = 40, .entry = 50},
        {.object = 9, .pixels = 1, .share = 0.1, .distance = 50, .entry = 40},
        {.object = 3, .pixels = 1, .share = 0.1, .distance = 50, .entry = 50},
    };
    const conus_result other[TIED] = {
        {.object = 4, .pixels = 1, .share = 0.2, .distance = 40, .entry = 40},
        {.object = 4, .pixels = 1, .share = 0.1, .distance = 40, .entry = 40},
        {.object = 4, .pixels = 1, .share = 0.1, .distance = 50, .entry = 40},
        {.object = 4, .pixels = 1, .share = 0.1, .distance = 50, .entry = 50},
        {.object = 4, .pixels = 1, .share = 0.1, .distance = 50, .entry = 50},
    };
    for (int i = 0; i < TIED; i++) {
        assert_first(&best[i], &other[i]);
    }
}

/* An occluded object has no distance. Where all else ties it comes after those that have one, and then by entry. */
static void occluded_objects_come_last(void **state)
{
    (void)state;
    const conus_result seen = {.object = 9, .distance = 90, .entry = 90};
    const conus_result hidden = {.object = 4, .distance = NAN, .entry = 10};
    const conus_result deeper = {.object = 2, .distance = NAN, .entry = 20};
    assert_first(&seen, &hidden);
    assert_first(&hidden, &deeper);
}

static conus_volume_info grid_at(const size_t dim[3], const double corner[3])
{
    double m[16];
    mat4_identity(m);
    memcpy(m + 12, corner, 3 * sizeof *m);
    return scene_plain_grid(dim, m);
}

/* By 16 x 16 rays where none are said. */
static double score_of(const conus_atlas *atlas, const conus_selector_options *options, const conus_pose *pose,
                       double degrees, uint32_t object)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    double score = NAN;
    conus_selector_options of16 = *options;
    of16.resolution = of16.resolution ? of16.resolution : 16;
    assert_ok(conus_selector_create(&selector, atlas, &of16));
    assert_ok(conus_select(&selection, selector, pose, degrees));
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        score = result->object == object ? result->score : score;
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return score;
}

/* A device at (x, y, z) that looks down, with x to the right and y up. */
static conus_pose looking_down(double x, double y, double z)
{
    return (conus_pose){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1}};
}

enum { N = 16 };

static bool is_round(int i, int j)
{
    int x = 2 * i + 1 - N; /* 16 u and 16 v */
    int y = 2 * j + 1 - N;
    return i >= 0 && j >= 0 && i < N && j < N && x * x + y * y <= N * N;
}

/* A cylinder of 8 mm has one pixel per voxel of 1 mm: each voxel in turn is a separate area. */
static void the_rim_is_every_pixel_with_a_neighbour_outside(void **state)
{
    (void)state;
    const conus_volume_info info = grid_at((size_t[]){N, N, 1}, (double[]){-7.5, -7.5, 0});
    const conus_pose pose = looking_down(0, 0, 20);
    int rim = 0;
    for (int pixel = 0; pixel < N * N; pixel++) {
        int i = pixel % N;
        int j = pixel / N;
        uint32_t labels[N * N];
        if (!is_round(i, j)) {
            continue;
        }
        for (int v = 0; v < N * N; v++) {
            labels[v] = v == pixel ? 1 : 2;
        }
        conus_atlas *atlas = scene_parcellation(&info, labels);
        bool inner = is_round(i - 1, j) && is_round(i + 1, j) && is_round(i, j - 1) && is_round(i, j + 1);
        rim += !inner;
        assert_near(score_of(atlas, &(conus_selector_options){.score = "smallest", .radius = 8}, &pose, 0, 1),
                    inner ? 2 - 1 / 208.0 : 1 / 208.0, 1e-15);
        conus_atlas_destroy(atlas);
    }
    assert_int_equal(rim, 44); /* by the rows, from the lowest: 6, 4, 4, 2, 2 and 6 times 2 / 2, mirrored */
}

static void add_scalar(conus_atlas *atlas, conus_role role, const size_t dim[3], const double corner[3], size_t voxel)
{
    conus_volume_info info = grid_at(dim, corner);
    float *values = memory_zeroed(dim[0] * dim[1] * dim[2], sizeof *values);
    assert_non_null(values);
    values[voxel] = 1;
    info.role = role;
    info.threshold = 0.5;
    if (role == CONUS_ROLE_CONTEXT) {
        assert_ok(atlas_set_context(atlas, &info, values));
    } else {
        assert_ok(pathway_of_values(atlas, &info, values, "tract"));
    }
}

/* The cells of area 1 fill x, y and z from -2 to 2 in a grid from -10 to 10. The pathway's only voxel, at (4, 0, 1),
 * has a grid of its own from -30 to 30; it moves the box to x = 4.5. The context's voxel, far below, blocks, and moves
 * nothing. Seen from (1, 0, 12): near = 10, far from the corner (-2, 2, -2), whose offset is (3, 2, 14); the area
 * begins at 10 / cos of the least angle. */
static void nearness_goes_by_areas_and_pathways(void **state)
{
    (void)state;
    uint32_t labels[20 * 20 * 20] = {0};
    for (size_t v = 0; v < sizeof labels / sizeof labels[0]; v++) {
        bool inside = true;
        for (size_t at = v, a = 0; a < 3; at /= 20, a++) {
            inside = inside && at % 20 >= 8 && at % 20 < 12;
        }
        labels[v] = inside;
    }
    const conus_volume_info info = grid_at((size_t[]){20, 20, 20}, (double[]){-9.5, -9.5, -9.5});
    conus_atlas *atlas = scene_parcellation(&info, labels);
    const conus_pose pose = looking_down(1, 0, 12);
    const conus_selector_options options = {.score = "nearness", .resolution = 1};
    assert_near(score_of(atlas, &options, &pose, 5, 1), 1, 1e-15); /* the axis hits it where the box begins */
    const conus_pose raised = looking_down(0.25, 0.25, 112);       /* and another grid's edge does not matter */
    assert_near(score_of(atlas, &options, &raised, 5, 1), 1, 1e-15);
    add_scalar(atlas, CONUS_ROLE_SCALAR, (size_t[]){61, 61, 61}, (double[]){-30, -30, -30}, 34 + 61 * (30 + 61 * 31));
    add_scalar(atlas, CONUS_ROLE_CONTEXT, (size_t[]){3, 3, 3}, (double[]){-1, -1, -90}, 13);
    double low[3];
    double high[3];
    assert_ok(conus_atlas_bounds(low, high, atlas));
    const double wanted[2][3] = {{-2, -2, -2}, {4.5, 2, 2}};
    for (int a = 0; a < 3; a++) {
        assert_near(low[a], wanted[0][a], 1e-12);
        assert_near(high[a], wanted[1][a], 1e-12);
    }
    /* From beside, at (5, 0, 12) towards -z and -x by (4, 0, 12): the ray meets z = 2 at x = 5 - 10/3, so at the
     * distance 10 sqrt(1 + 1/9). near: to (4.5, 0, 2); far: to (-2, +-2, -2). */
    conus_pose beside;
    assert_ok(conus_pose_along(&beside, (double[]){5, 0, 12}, (double[]){-4, 0, -12}, NULL));
    double near = hypot(0.5, 10);
    double far = sqrt(7.0 * 7 + 2 * 2 + 14 * 14);
    assert_near(score_of(atlas, &options, &beside, 5, 1), 1 - (10 * sqrt(10.0 / 9) - near) / (far - near), 1e-12);
    conus_atlas_destroy(atlas);
}

static void extend(double low[3], double high[3], const double p[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = fmin(low[a], p[a]);
        high[a] = fmax(high[a], p[a]);
    }
}

static void try_cell(double low[3], double high[3], const struct volume *volume, size_t v)
{
    const size_t *dim = volume->info.dim;
    const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
    for (unsigned corner = 0; corner < 8; corner++) {
        double p[3];
        for (unsigned a = 0; a < 3; a++) {
            p[a] = (double)at[a] + (corner >> a & 1 ? 0.5 : -0.5);
        }
        mat4_point(p, volume->info.world_from_voxel, p);
        extend(low, high, p);
    }
}

/* The box around all corners of all cells that hold an object, one by one. */
static void try_every_cell(double low[3], double high[3], const conus_atlas *atlas)
{
    low[0] = low[1] = low[2] = INFINITY;
    high[0] = high[1] = high[2] = -INFINITY;
    for (size_t n = 0; n < atlas->volume_count; n++) {
        for (size_t v = 0; v < atlas->volumes[n].voxel_count; v++) {
            if (volume_object(&atlas->volumes[n], v)) {
                try_cell(low, high, &atlas->volumes[n], v);
            }
        }
    }
}

/* The parcellation with `by` more empty voxels around it. */
static conus_atlas *padded(const conus_atlas *atlas, size_t by)
{
    const struct volume *from = &atlas->volumes[0];
    conus_volume_info info = from->info;
    double m[16];
    memcpy(m, info.world_from_voxel, sizeof m);
    mat4_point(m + 12, info.world_from_voxel, (double[]){-(double)by, -(double)by, -(double)by});
    for (int a = 0; a < 3; a++) {
        info.dim[a] += 2 * by;
    }
    assert_ok(space_describe(&info, m, "padded"));
    uint32_t *labels = memory_zeroed(info.dim[0] * info.dim[1] * info.dim[2], sizeof *labels);
    assert_non_null(labels);
    for (size_t v = 0; v < from->voxel_count; v++) {
        const size_t *dim = from->info.dim;
        uint32_t object = volume_object(from, v);
        labels[v % dim[0] + by + info.dim[0] * (v / dim[0] % dim[1] + by + info.dim[1] * (v / dim[0] / dim[1] + by))] =
            object ? atlas->objects[object - 1].label : 0;
    }
    conus_atlas *out = scene_parcellation(&info, labels);
    memory_free(labels);
    return out;
}

static void assert_same_scores(const conus_atlas *a, const conus_atlas *b, const conus_pose *pose)
{
    for (uint32_t object = 1; object <= a->object_count; object++) {
        const conus_selector_options options = {.score = "nearness", .resolution = 16};
        double x = score_of(a, &options, pose, 40, object);
        double y = score_of(b, &options, pose, 40, object);
        assert_true(!isnan(x) == !isnan(y));
        if (!isnan(x)) {
            assert_near(x, y, 1e-9);
        }
    }
}

static void empty_borders_change_nothing(void **state)
{
    (void)state;
    uint64_t seed = 7;
    int compared = 0;
    for (int i = 0; i < 60; i++) {
        conus_atlas *atlas = scene_atlas(&seed, 20, i % 3);
        double low[2][3];
        double high[2][3];
        if (!conus_atlas_bounds(low[0], high[0], atlas)) {
            try_every_cell(low[1], high[1], atlas);
            for (int a = 0; a < 3; a++) {
                assert_near(low[0][a], low[1][a], 1e-9);
                assert_near(high[0][a], high[1][a], 1e-9);
            }
        }
        if (i % 3 == 0) {
            conus_atlas *more = padded(atlas, 1 + (size_t)i % 5);
            const conus_pose pose = scene_generic_pose(&seed, atlas);
            assert_int_equal(more->object_count, atlas->object_count);
            assert_same_scores(atlas, more, &pose);
            compared += atlas->object_count > 0;
            conus_atlas_destroy(more);
        }
        conus_atlas_destroy(atlas);
    }
    assert_true(compared > 10);
}

/* A tetrahedron's four corners count; the fifth vertex belongs to no triangle. */
static void meshes_count_by_their_triangles(void **state)
{
    (void)state;
    static const float positions[5][3] = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0, 0, -5}, {90, 90, 90}};
    static const uint32_t triangles[12] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    const conus_object area = {.label = 1, .name = "wedge", .abbreviation = ""};
    conus_atlas *atlas = NULL;
    struct mesh mesh = {0};
    assert_ok(atlas_create_empty(&atlas, "here"));
    assert_ok(mesh_init(&mesh, 5, 4));
    memcpy(mesh.positions, positions, sizeof positions);
    memcpy(mesh.triangles, triangles, sizeof triangles);
    assert_ok(atlas_add_mesh(atlas, &area, &mesh));
    double low[3];
    double high[3];
    assert_ok(conus_atlas_bounds(low, high, atlas));
    for (int a = 0; a < 3; a++) {
        assert_near(low[a], a == 2 ? -5 : 0, 0);
        assert_near(high[a], a == 0 ? 3 : a == 1 ? 4 : 0, 0);
    }
    conus_atlas_destroy(atlas);
    assert_ok(atlas_create_empty(&atlas, "nothing"));
    assert_fails(conus_atlas_bounds(low, high, atlas), CONUS_ERROR_DATA);
    conus_atlas_destroy(atlas);
}

/* numpy on the file: the voxels with labels have indices 17 to 162, 20 to 199 and 10 to 155, so their cells fill
 * [-73.5, 72.5] x [-105.5, 74.5] x [-61.5, 84.5]; from (-90, 20, 20) near is 16.5 and far |(162.5, 125.5, 81.5)| =
 * 220.90439. Frontal_Inf_Oper_L begins at 25.531376 mm (compare_query checks distances), so 0.9558161. */
static void nearness_in_aal(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    conus_pose pose;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    assert_ok(conus_pose_toward(&pose, (double[]){-90, 20, 20}, (double[]){0, -10, 10}, NULL));
    const conus_selector_options options = {.score = "nearness", .resolution = 16};
    assert_near(score_of(atlas, &options, &pose, 20, 11), 0.9558161, 5e-8);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(ranking)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ties_go_by_share_distance_entry_and_number),
        cmocka_unit_test(occluded_objects_come_last),
        cmocka_unit_test(the_rim_is_every_pixel_with_a_neighbour_outside),
        cmocka_unit_test(nearness_goes_by_areas_and_pathways),
        cmocka_unit_test(empty_borders_change_nothing),
        cmocka_unit_test(meshes_count_by_their_triangles),
        cmocka_unit_test(nearness_in_aal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
