/* SPDX-License-Identifier: BSD-3-Clause */
/* Leeways (Eq. 22): against their definition, by points along the axis and distances from everything that is not the
 * structure, one by one; and against poses that deviate by less, none of which may break a constraint. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/plan/plan.h"
#include "tables.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 500, EDGE = 7 };

/* Needles, each from its apex to its far end. */
struct needles {
    double (*ends)[2][3];
    size_t count;
};

static const char *write_ends(const char *name, const struct needles *needles)
{
    struct buffer text = {0};
    buffer_text(&text, "x\ty\tz\tdx\tdy\tdz\tfar\n");
    for (size_t i = 0; i < needles->count; i++) {
        double along[3];
        vec3_sub(along, needles->ends[i][1], needles->ends[i][0]);
        for (int a = 0; a < 6; a++) {
            buffer_format(&text, "%.17g\t", a < 3 ? needles->ends[i][0][a] : along[a - 3]);
        }
        buffer_format(&text, "%.17g\n", vec3_length(along));
    }
    const char *path = test_scratch(name);
    assert_ok(buffer_status(&text));
    assert_ok(file_write(path, text.data, text.size));
    buffer_finish(&text);
    return path;
}

/* Runs the poses of a file; their number is known whatever `top` is. */
static conus_plan *run(conus_selector *selector, const conus_constraint *constraints, size_t count, const char *path,
                       uint64_t top)
{
    conus_plan *plan = NULL;
    conus_pose_stream *stream = NULL;
    assert_ok(conus_plan_create(&plan, selector, constraints, count, &(conus_plan_options){.top = top, .threads = 1}));
    assert_ok(conus_pose_stream_open(&stream, path, NULL));
    assert_ok(conus_plan_run(plan, stream, UINT64_MAX));
    conus_pose_stream_destroy(stream);
    return plan;
}

/* A turned, flipped and perhaps sheared grid with blobs of objects 1 and 2. */
static conus_atlas *blobs(uint64_t *seed)
{
    conus_volume_info grid = scene_grid(seed, (const size_t[]){EDGE, EDGE, EDGE});
    uint32_t labels[EDGE * EDGE * EDGE];
    for (size_t i = 0; i < EDGE * EDGE * EDGE; i++) {
        size_t at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double away[3] = {(double)at[0] - 3.2, (double)at[1] - 3, (double)at[2] - 2.9};
        double distance = vec3_length(away) + test_random(seed, -0.6, 0.6);
        labels[i] = distance < 2 ? 1 : distance < 3.2 ? 2 : 0;
    }
    return scene_parcellation(&grid, labels);
}

/* Distance from a point to the parallelepiped of a cell, one coordinate after the other until nothing changes. */
static double cell_distance(const struct volume *volume, const double cell[3], const double point[3])
{
    double x[3] = {cell[0], cell[1], cell[2]};
    double rest[3];
    const double *m = volume->info.world_from_voxel;
    for (int round = 0; round < 200; round++) {
        double moved = 0;
        for (int a = 0; a < 3; a++) {
            mat4_point(rest, m, x);
            vec3_sub(rest, point, rest);
            double best = x[a] + vec3_dot(rest, m + 4 * a) / vec3_dot(m + 4 * a, m + 4 * a);
            best = fmin(fmax(best, cell[a] - 0.5), cell[a] + 0.5);
            moved += fabs(best - x[a]);
            x[a] = best;
        }
        if (moved < 1e-9) {
            break;
        }
    }
    mat4_point(rest, m, x);
    vec3_sub(rest, point, rest);
    return vec3_length(rest);
}

/* Distance from a point to everything that is not object 1: other cells, and a layer of cells around the grid. */
static double other_distance(const struct volume *volume, const double point[3])
{
    double best = INFINITY;
    size_t voxel;
    if (!volume_find_voxel(&voxel, volume, point) || volume_object(volume, voxel) != 1) {
        return 0;
    }
    for (int i = -1; i <= EDGE; i++) {
        for (int j = -1; j <= EDGE; j++) {
            for (int k = -1; k <= EDGE; k++) {
                bool is_in_grid = i >= 0 && j >= 0 && k >= 0 && i < EDGE && j < EDGE && k < EDGE;
                if (!is_in_grid || volume_object(volume, (size_t)i + EDGE * ((size_t)j + EDGE * (size_t)k)) != 1) {
                    double cell[3] = {i, j, k};
                    best = fmin(best, cell_distance(volume, cell, point));
                }
            }
        }
    }
    return best;
}

static void leeways_of_lengths_are_those_of_points(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (size_t trial = 0; trial < test_trials(12); trial++) {
        conus_atlas *atlas = blobs(&seed);
        const struct volume *volume = &atlas->volumes[0];
        double ends[1][2][3];
        double middle[3];
        double cell = cbrt(fabs(mat4_determinant3(volume->info.world_from_voxel)));
        scene_voxel(middle, volume, EDGE * EDGE * EDGE / 2);
        for (int a = 0; a < 3; a++) {
            double aside = test_random(&seed, -cell, cell);
            double way = test_random(&seed, -9, 9) * cell;
            ends[0][0][a] = middle[a] + aside - way;
            ends[0][1][a] = middle[a] + aside + way * (trial % 3 ? 1 : 0.1); /* now and then it ends inside */
        }
        conus_selector *selector = NULL;
        conus_constraint want = {.names = "1", .limit = trial % 2 ? 0 : cell};
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        conus_plan *plan = run(selector, &want, 1, write_ends("points.tsv", &(struct needles){ends, 1}), UINT64_MAX);
        const conus_planned *planned = conus_plan_pose(plan, 0);
        double length = 0;
        double deepest = 0;
        double least = planned ? planned->leeway : 0;
        double along[3];
        vec3_sub(along, ends[0][1], ends[0][0]);
        double step = vec3_length(along) / SAMPLES;
        for (int i = 0; i < SAMPLES && planned; i++) {
            double point[3];
            vec3_add_scaled(point, ends[0][0], (i + 0.5) / SAMPLES, along);
            double distance = other_distance(volume, point);
            length += distance >= least ? step : 0;
            deepest = fmax(deepest, distance);
        }
        if (planned && want.limit > 0) { /* each stretch has two ends within a step */
            assert_near(length, want.limit, 8 * step);
        } else if (planned) {
            assert_near(least, deepest, step);
        }
        conus_plan_destroy(plan);
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
}

static void random_direction(double out[3], uint64_t *seed)
{
    double length;
    do {
        for (int a = 0; a < 3; a++) {
            out[a] = test_random(seed, -1, 1);
        }
        length = vec3_length(out);
    } while (length > 1 || length < 0.01);
    vec3_scale(out, out, 1 / length);
}

/* Fills `out` with needles as long as `of`, all of whose points are nearer than `limit` to those of `of` at equal
 * depth: if both ends are, so is all between them. */
static void deviate(struct needles *out, double of[2][3], double limit, uint64_t *seed)
{
    double axis[3];
    vec3_sub(axis, of[1], of[0]);
    double length = vec3_length(axis);
    for (size_t i = 0; i < out->count;) {
        double(*ends)[3] = out->ends[i];
        double away[3];
        for (int end = 0; end < 2; end++) {
            random_direction(away, seed);
            vec3_add_scaled(ends[end], of[end], limit * (i % 4 ? test_random(seed, 0.9, 1) : 1), away);
        }
        vec3_sub(axis, ends[1], ends[0]);
        vec3_add_scaled(ends[1], ends[0], length / vec3_length(axis), axis);
        vec3_sub(away, ends[1], of[1]);
        i += vec3_length(away) <= limit;
    }
}

/* Lists poses from around `middle`. For each of them deviations within 0.999 of its leeway break nothing, and one
 * beyond the leeway of an avoided structure, towards its nearest point, does. */
static void check_deviations(const conus_atlas *atlas, const conus_constraint *constraints, size_t count,
                             size_t avoided, const double middle[3], double size, double radius, uint64_t *seed)
{
    enum { TRIED = 100, OF_EACH = 500 };
    struct needles tried = {memory_zeroed(TRIED, sizeof *tried.ends), TRIED};
    struct needles around = {memory_zeroed(OF_EACH, sizeof *around.ends), test_trials(OF_EACH)};
    assert_true(tried.ends && around.ends);
    for (size_t i = 0; i < TRIED; i++) {
        double away[3];
        random_direction(away, seed);
        vec3_add_scaled(tried.ends[i][0], middle, size * test_random(seed, 1.5, 2.5), away);
        random_direction(away, seed);
        vec3_add_scaled(tried.ends[i][1], middle, size * test_random(seed, 0, 0.7), away);
    }
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.radius = radius}));
    conus_plan *plan = run(selector, constraints, count, write_ends("tried.tsv", &tried), UINT64_MAX);
    size_t listed = conus_plan_count(plan);
    size_t done = 0;
    assert_true(listed > 4);
    for (size_t i = 0; i < listed && done < 4; i += listed / 4, done++) {
        const conus_planned *planned = conus_plan_pose(plan, i);
        double ends[2][3];
        memcpy(ends, tried.ends[planned->candidate - 1], sizeof ends);
        if (planned->leeway < 1e-6) {
            continue;
        }
        deviate(&around, ends, 0.999 * planned->leeway, seed);
        conus_plan *deviations = run(selector, constraints, count, write_ends("around.tsv", &around), 1);
        assert_int_equal(conus_plan_left(deviations, 0), around.count);
        assert_int_equal(conus_plan_left(deviations, count), around.count);
        conus_plan_destroy(deviations);
        if (avoided < count) {
            conus_table *clearances = NULL;
            conus_selector *ranged = NULL;
            assert_ok(conus_selector_create(
                &ranged, atlas, &(conus_selector_options){.radius = radius, .range = {planned->near, planned->far}}));
            assert_ok(conus_clearance(&clearances, ranged, &planned->pose, 1000));
            size_t nearest = table_row_of(clearances, planned->verdicts[avoided].object);
            assert_near(table_number_at(clearances, "distance_mm", nearest), planned->verdicts[avoided].value, 1e-12);
            double toward[3];
            double at[3];
            table_point_at(toward, clearances, "near_", nearest);
            table_point_at(at, clearances, "", nearest);
            vec3_sub(toward, toward, at);
            vec3_scale(toward, toward, 1.05 * planned->verdicts[avoided].leeway / vec3_length(toward));
            for (int end = 0; end < 2; end++) {
                vec3_add_scaled(around.ends[0][end], ends[end], 1, toward);
            }
            conus_plan *beyond =
                run(selector, constraints + avoided, 1, write_ends("beyond.tsv", &(struct needles){around.ends, 1}), 1);
            assert_int_equal(conus_plan_left(beyond, 1), 0);
            conus_plan_destroy(beyond);
            conus_table_destroy(clearances);
            conus_selector_destroy(ranged);
        }
    }
    conus_plan_destroy(plan);
    conus_selector_destroy(selector);
    memory_free(tried.ends);
    memory_free(around.ends);
}

static void voxels_let_poses_deviate(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int trial = 0; trial < 2; trial++) {
        conus_volume_info grid = scene_grid(&seed, (const size_t[]){12, 12, 12});
        uint32_t labels[12 * 12 * 12];
        for (size_t i = 0; i < 12 * 12 * 12; i++) {
            size_t at[3] = {i % 12, i / 12 % 12, i / 144};
            double x = (double)at[0] - 5.5;
            double y = (double)at[1] - 5.5;
            double z = (double)at[2] - 5.5;
            labels[i] = x * x + y * y + z * z < 12 ? 1 + (x > 0) : z > 4 && x < 1 ? 3 : 0; /* two halves and a lid */
        }
        conus_atlas *atlas = scene_parcellation(&grid, labels);
        double cell = cbrt(fabs(mat4_determinant3(atlas->volumes[0].info.world_from_voxel)));
        double middle[3];
        mat4_point(middle, atlas->volumes[0].info.world_from_voxel, (const double[]){5.5, 5.5, 5.5});
        const conus_constraint wants[2] = {{.names = "1,2", .limit = 2 * cell},
                                           {.kind = CONUS_CONSTRAINT_AVOID, .names = "3", .limit = 0.1 * cell}};
        check_deviations(atlas, wants, 2, 1, middle, 3.5 * cell, 0.1 * cell, &seed);
        const conus_constraint tip = {.measure = CONUS_MEASURE_TIP, .names = "2"};
        check_deviations(atlas, &tip, 1, 1, middle, 3.5 * cell, 0, &seed);
        conus_atlas_destroy(atlas);
    }
}

static void surfaces_let_poses_deviate(void **state)
{
    (void)state;
    uint64_t seed = 4;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((const double[]){0, 0, 0}, 10, 12, 16);
    mesh_scene_add(atlas, &ball);
    struct mesh box = mesh_scene_box((const double[]){-20, 5, -20}, (const double[]){20, 8, -12});
    mesh_scene_add(atlas, &box);
    const conus_constraint wants[2] = {{.names = "1", .limit = 4},
                                       {.kind = CONUS_CONSTRAINT_AVOID, .names = "2", .limit = 1}};
    check_deviations(atlas, wants, 2, 1, (const double[]){0, 0, 0}, 10, 0.5, &seed);
    conus_atlas_destroy(atlas);
}

/* Through the middle of a ball of R the points with D >= d are 2 (R - d) long; a surface of quadrilaterals lies inside
 * of it. */
static void a_sphere(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh ball = mesh_scene_sphere((const double[]){0, 0, 0}, 10, 96, 96);
    mesh_scene_add(atlas, &ball);
    conus_selector *selector = NULL;
    double ends[1][2][3] = {{{-30, -1, 2}, {30, 1, -2}}};
    conus_constraint want = {.names = atlas->objects[0].name, .limit = 12};
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    conus_plan *plan = run(selector, &want, 1, write_ends("sphere.tsv", &(struct needles){ends, 1}), UINT64_MAX);
    assert_near(conus_plan_pose(plan, 0)->leeway, 4, 0.02);
    conus_plan_destroy(plan);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Streamlines of radius 2 along x: 1 mm from the line of one, an axis across it is in it for 2 sqrt(3) mm. */
static void tubes(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    double radius = atlas->tractograms[0].radius;
    double ends[1][2][3] = {{{10, -20, 30 + radius / 2}, {10, -20 + 30, 30 + radius / 2}}};
    conus_selector *selector = NULL;
    conus_constraint want = {.names = "near", .limit = radius};
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    conus_plan *plan = run(selector, &want, 1, write_ends("tubes.tsv", &(struct needles){ends, 1}), UINT64_MAX);
    /* Two of them, at y = 0 and 3: with the radius r - d they are passed for 4 sqrt((r - d)^2 - r^2 / 4), or, where
     * they overlap, for 3 mm and half of that. */
    double wanted = radius - sqrt(radius * radius / 16 + radius * radius / 4);
    assert_near(conus_plan_pose(plan, 0)->leeway, wanted, 2e-6);
    assert_true(plan_asked_of(plan)->constraints[0].has_leeway);
    conus_plan_destroy(plan);
    conus_selector_destroy(selector);
    const double middle[3] = {10, 0, 30};
    const conus_constraint narrow = {.names = "near", .limit = radius / 2};
    uint64_t seed = 9;
    check_deviations(atlas, &narrow, 1, 1, middle, 2 * radius, 0, &seed);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(plan_leeway)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leeways_of_lengths_are_those_of_points),
        cmocka_unit_test(voxels_let_poses_deviate),
        cmocka_unit_test(surfaces_let_poses_deviate),
        cmocka_unit_test(a_sphere),
        cmocka_unit_test(tubes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
