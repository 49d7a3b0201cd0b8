/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 21: the clearance of needles from objects. Cells, triangles and tubes in closed form, and against a search that
 * only uses the distance of a point from a cell, a triangle or a polyline. */
#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/selection.h"
#include "selection/study/study.h"
#include "tables.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static conus_table *measure(const conus_atlas *atlas, const conus_selector_options *options, const conus_pose *pose,
                            double within)
{
    conus_selector *selector = NULL;
    conus_table *clearances = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_clearance(&clearances, selector, pose, within));
    conus_selector_destroy(selector);
    return clearances;
}

static conus_pose along(double x, double y, double z, double dx, double dy, double dz)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (const double[]){x, y, z}, (const double[]){dx, dy, dz}, NULL));
    return pose;
}

/* A known row: distance, depth, and the nearest point. */
struct wanted {
    uint32_t object;
    double distance, depth;
    double near[3];
};

static struct wanted row_at(const conus_table *clearances, size_t i)
{
    struct wanted row = {.object = conus_table_objects(clearances)[i],
                         .distance = table_number_at(clearances, "distance_mm", i),
                         .depth = table_number_at(clearances, "depth_mm", i)};
    table_point_at(row.near, clearances, "near_", i);
    return row;
}

static void check_row(const struct wanted *row, const struct wanted *wanted, double tolerance)
{
    assert_int_equal(row->object, wanted->object);
    assert_near(row->distance, wanted->distance, tolerance);
    assert_near(row->depth, wanted->depth, tolerance);
    for (int a = 0; a < 3; a++) {
        assert_near(row->near[a], wanted->near[a], tolerance);
    }
}

/* One voxel of 2 x 4 x 6 mm round (10, 20, 30): x from 9 to 11, y from 18 to 22, z from 27 to 33. */
static conus_atlas *one_cell(void)
{
    static const size_t dim[3] = {1, 1, 1};
    const double m[16] = {2, 0, 0, 0, 0, 4, 0, 0, 0, 0, 6, 0, 10, 20, 30, 1};
    const conus_volume_info grid = scene_plain_grid(dim, m);
    return scene_parcellation(&grid, (const uint32_t[]){7});
}

static void a_box_is_as_far_as_its_nearest_part(void **state)
{
    (void)state;
    const struct {
        double at[3], along[3], range[2];
        struct wanted wanted;
    } cases[] = {
        /* past a face, along it: from where it is beside it */
        {{10, 0, 35}, {0, 1, 0}, {0, 0}, {1, 2, 18, {10, 18, 33}}},
        /* the same, from beside it on, and to before it */
        {{10, 19, 35}, {0, 1, 0}, {0, 50}, {1, 2, 0, {10, 19, 33}}},
        {{10, 0, 35}, {0, 1, 0}, {0, 15}, {1, sqrt(13), 15, {10, 18, 33}}},
        /* begins beyond it */
        {{10, 0, 35}, {0, 1, 0}, {26, 40}, {1, sqrt(20), 26, {10, 22, 33}}},
        /* past an edge along x, at 45 degrees: nearest where z - y = 11 comes nearest to (22, 33) */
        {{10, 24.5, 25}, {0, 0, 1}, {0, 0}, {1, 2.5, 2, {10, 22, 27}}},
        {{10, 30, 27}, {0, -1, 1}, {0, 0}, {1, sqrt(2), 7 * sqrt(2), {10, 22, 33}}},
        /* past a corner: (11, 22, 33) + (1, 1, 0) is the foot */
        {{12, 23, 23}, {0, 0, 1}, {12, 20}, {1, sqrt(6), 12, {11, 22, 33}}},
        {{7, 28, 33}, {1, -1, 0}, {0, 0}, {1, sqrt(2), 5 * sqrt(2), {11, 22, 33}}},
        /* into a face, and from inside */
        {{10, 20, 0}, {0, 0, 1}, {0, 0}, {1, 0, 27, {10, 20, 27}}},
        {{10, 20, 0}, {0, 0, 1}, {0, 20}, {1, 7, 20, {10, 20, 27}}},
        {{10, 20, 0}, {0, 0, 1}, {29, 40}, {1, 0, 29, {10, 20, 29}}},
        /* touches a corner, and runs in a face */
        {{9, 21, 32}, {1, 1, 1}, {0, 0}, {1, 0, 0, {9, 21, 32}}},
        {{11, 0, 30}, {0, 1, 0}, {0, 0}, {1, 0, 18, {11, 18, 30}}},
        /* points away */
        {{10, 20, 40}, {0, 0, 1}, {0, 0}, {1, 7, 0, {10, 20, 33}}},
    };
    conus_atlas *atlas = one_cell();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double *at = cases[i].at;
        const double *to = cases[i].along;
        const conus_pose pose = along(at[0], at[1], at[2], to[0], to[1], to[2]);
        const conus_selector_options options = {.range = {cases[i].range[0], cases[i].range[1]}};
        conus_table *clearances = measure(atlas, &options, &pose, 100);
        assert_int_equal(conus_table_rows(clearances), 1);
        const struct wanted row = row_at(clearances, 0);
        check_row(&row, &cases[i].wanted, 1e-12);
        conus_table_destroy(clearances);
    }
    conus_atlas_destroy(atlas);
}

/* Distance of `point` from a cell, by minimising the offsets x along its edges in turn while the others are fixed: the
 * function is convex. Uses nothing of the library but the matrix. */
static long double cell_distance(const struct volume *volume, const double voxel[3], const long double point[3])
{
    const double *m = volume->info.world_from_voxel;
    long double x[3] = {0, 0, 0};
    long double to[3];
    for (int r = 0; r < 3; r++) {
        to[r] = m[12 + r] - point[r];
        for (int a = 0; a < 3; a++) {
            to[r] += (long double)m[4 * a + r] * voxel[a];
        }
    }
    long double moved = 1;
    for (int round = 0; round < 2000 && moved > 1e-17L; round++) {
        moved = 0;
        for (int a = 0; a < 3; a++) {
            long double dot = 0;
            long double square = 0;
            for (int r = 0; r < 3; r++) {
                dot += m[4 * a + r] * to[r];
                square += (long double)m[4 * a + r] * m[4 * a + r];
            }
            long double next = fminl(fmaxl(x[a] - dot / square, -0.5L), 0.5L);
            moved = fmaxl(moved, fabsl(next - x[a]));
            for (int r = 0; r < 3; r++) {
                to[r] += (next - x[a]) * m[4 * a + r];
            }
            x[a] = next;
        }
    }
    return sqrtl(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
}

struct cubelet {
    const struct volume *volume;
    double voxel[3];
};

static long double distance_at(const struct cubelet *cell, const struct needle *needle, long double t)
{
    long double point[3];
    for (int a = 0; a < 3; a++) {
        point[a] = needle->origin[a] + t * needle->direction[a];
    }
    return cell_distance(cell->volume, cell->voxel, point);
}

/* The least distance of a cell by ternary search: it is convex along the needle. */
static double least_of_cell(const struct cubelet *cell, const struct needle *needle)
{
    long double low = needle->near;
    long double high = needle->far;
    for (int i = 0; i < 120; i++) {
        long double a = low + (high - low) / 3;
        long double b = high - (high - low) / 3;
        if (distance_at(cell, needle, a) <= distance_at(cell, needle, b)) {
            high = b;
        } else {
            low = a;
        }
    }
    return (double)distance_at(cell, needle, low);
}

/* The least distance of the cells of `object`, of those that may be nearer than `least` by their centres and half
 * diagonals. */
static double least_of_object(const conus_atlas *atlas, uint32_t object, const struct needle *needle, double least)
{
    double found = INFINITY;
    for (size_t v = 0; v < atlas->volume_count; v++) {
        const struct volume *volume = &atlas->volumes[v];
        const double *m = volume->info.world_from_voxel;
        double half = (vec3_length(m) + vec3_length(m + 4) + vec3_length(m + 8)) / 2;
        for (size_t i = 0; i < volume->voxel_count; i++) {
            double centre[3];
            double foot[3];
            if (volume->info.role == CONUS_ROLE_CONTEXT || volume_object(volume, i) != object) {
                continue;
            }
            scene_voxel(centre, volume, i);
            vec3_sub(foot, centre, needle->origin);
            double t = fmin(fmax(vec3_dot(foot, needle->direction), needle->near), needle->far);
            vec3_add_scaled(foot, foot, -t, needle->direction);
            if (vec3_length(foot) - half <= least + 1e-6) {
                const size_t *dim = volume->info.dim;
                const size_t at[3] = {i % dim[0], i / dim[0] % dim[1], i / dim[0] / dim[1]};
                const struct cubelet cell = {volume, {(double)at[0], (double)at[1], (double)at[2]}};
                found = fmin(found, least_of_cell(&cell, needle));
            }
        }
    }
    return found;
}

static struct needle needle_of(const conus_pose *pose, double near, double far)
{
    struct needle needle = {.near = near, .far = far};
    memcpy(needle.origin, pose->world_from_device + 12, sizeof needle.origin);
    vec3_scale(needle.direction, pose->world_from_device + 8, -1);
    return needle;
}

/* Random parcellations with pathways, oblique and sheared, every object's cells one by one. */
static void volumes_are_as_far_as_their_nearest_cell(void **state)
{
    (void)state;
    uint64_t seed = 21;
    size_t apart = 0;
    for (int round = 0; round < 150; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 9, round % 3);
        const conus_pose pose = round % 4 ? scene_generic_pose(&seed, atlas) : scene_pose(&seed, atlas);
        double near = test_random(&seed, 0, 10);
        double far = near + test_random(&seed, 0, 15);
        const struct needle needle = needle_of(&pose, near, far);
        conus_table *clearances = measure(atlas, &(conus_selector_options){.range = {near, far}}, &pose, INFINITY);
        size_t shown = 0;
        for (size_t i = 0; i < atlas->object_count; i++) {
            shown += atlas->objects[i].voxels > 0;
        }
        assert_int_equal(conus_table_rows(clearances), shown);
        for (size_t i = 0; i < conus_table_rows(clearances); i++) {
            const struct wanted row = row_at(clearances, i);
            double at[3];
            double offset[3];
            table_point_at(at, clearances, "", i);
            double slack = 1e-9 + 1e-13 * vec3_length(needle.origin);
            assert_near(row.distance, least_of_object(atlas, row.object, &needle, row.distance), slack);
            vec3_sub(offset, at, row.near);
            assert_near(vec3_length(offset), row.distance, slack);
            needle_point(offset, &needle, row.depth);
            vec3_sub(offset, offset, at);
            assert_near(vec3_length(offset), 0, 1e-12);
            assert_true(row.depth >= near && row.depth <= far);
            apart += row.distance > 0;
        }
        conus_table_destroy(clearances);
        conus_atlas_destroy(atlas);
    }
    assert_true(apart > 200);
}

/* Clearances of the selector's last needle, of any length, from each object, within the limit. */
static const struct clearance *take(conus_selector *selector, const uint32_t *groups, const struct needle *needle,
                                    double limit)
{
    assert_ok(selector_prepare_clearance(selector));
    const struct clearance_question question = {.atlas = selector->atlas,
                                                .index = selector->clearance_index,
                                                .tracts = selector->tract_index,
                                                .groups = groups ? groups : level_group(selector->level),
                                                .limit = limit};
    clearance_take(&selector->clearance, &question, needle);
    return &selector->clearance;
}

/* A needle of length 0 is a ball's centre. */
static void a_point_is_as_far_as_a_ball_says(void **state)
{
    (void)state;
    uint64_t seed = 5;
    size_t rows = 0;
    for (int round = 0; round < 60; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 9, round % 3);
        struct mesh ball = mesh_scene_sphere((const double[]){1, 2, 3}, 4, 8, 8);
        conus_selector *selector = NULL;
        conus_selection *selection = NULL;
        const conus_pose pose = scene_generic_pose(&seed, atlas);
        const struct needle needle = needle_of(&pose, 0, 0);
        if (round % 3 == 0) {
            mesh_scene_add(atlas, &ball);
        } else {
            mesh_finish(&ball);
        }
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        assert_ok(conus_select_ball(&selection, selector, needle.origin, 25));
        const struct clearance *taken = take(selector, NULL, &needle, 25);
        assert_int_equal(taken->touched_count, conus_selection_count(selection) - 1);
        for (size_t i = 0; i < taken->touched_count; i++) {
            const conus_result *result = conus_selection_result(selection, i);
            const struct clearance_found *found = &taken->found[result->object];
            assert_near(found->distance, result->distance, 1e-9);
            assert_near(found->depth, 0, 0);
            for (int a = 0; a < 3; a++) {
                assert_near(found->point[a], result->contact[a], 1e-9);
            }
            rows++;
        }
        conus_selection_destroy(selection);
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
    assert_true(rows > 100);
}

/* Neither the limit nor the other objects change a bit; a group has the least of its members. */
static void an_answer_does_not_depend_on_the_question(void **state)
{
    (void)state;
    uint64_t seed = 8;
    for (int round = 0; round < 40; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 14, 0);
        conus_selector *selector = NULL;
        const conus_pose pose = round % 2 ? scene_generic_pose(&seed, atlas) : scene_pose(&seed, atlas);
        const struct needle needle = needle_of(&pose, 1, 20);
        struct clearance_found all[16];
        uint32_t groups[16] = {0};
        assert_true(atlas->object_count < 16);
        mesh_scene_add_soups(atlas, &seed);
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        memcpy(all, take(selector, NULL, &needle, 1e6)->found, (atlas->object_count + 1) * sizeof *all);
        struct clearance_found least = {.distance = INFINITY};
        for (uint32_t object = 1; object <= atlas->object_count; object++) {
            memset(groups, 0, sizeof groups);
            groups[object] = 1;
            const struct clearance *taken = take(selector, groups, &needle, 4);
            bool is_within = all[object].distance <= 4;
            assert_int_equal(taken->touched_count, is_within);
            const struct clearance_found *one = &taken->found[1];
            assert_true(!is_within || (one->distance == all[object].distance && one->depth == all[object].depth &&
                                       one->part == all[object].part && one->point[0] == all[object].point[0] &&
                                       one->point[1] == all[object].point[1] && one->point[2] == all[object].point[2]));
            if (all[object].distance < least.distance ||
                (all[object].distance == least.distance && all[object].depth < least.depth)) {
                least = all[object];
            }
        }
        for (uint32_t object = 1; object <= atlas->object_count; object++) {
            groups[object] = 2;
        }
        const struct clearance *taken = take(selector, groups, &needle, 1e6);
        assert_int_equal(taken->touched_count, 1);
        assert_true(taken->found[2].distance == least.distance && taken->found[2].depth == least.depth);
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
}

/* A longer needle is never farther away. */
static void distances_fall_with_the_far_end(void **state)
{
    (void)state;
    uint64_t seed = 13;
    for (int round = 0; round < 20; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 10, 0);
        conus_selector *selector = NULL;
        const conus_pose pose = scene_generic_pose(&seed, atlas);
        double last[16];
        mesh_scene_add_soups(atlas, &seed);
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        for (uint32_t object = 0; object < 16; object++) {
            last[object] = INFINITY;
        }
        for (int i = 0; i < 24; i++) {
            const struct needle needle = needle_of(&pose, 0, 1.7 * i);
            const struct clearance *taken = take(selector, NULL, &needle, 1e6);
            for (uint32_t object = 1; object <= atlas->object_count; object++) {
                assert_true(taken->found[object].distance <= last[object] + 1e-12 || last[object] == INFINITY);
                last[object] = taken->found[object].distance;
            }
        }
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
}

/* The grid and the needle are moved together, by up to a metre. */
static void motion_changes_nothing(void **state)
{
    (void)state;
    static const size_t dim[3] = {7, 6, 5};
    uint64_t seed = 34;
    for (int round = 0; round < 40; round++) {
        uint32_t labels[7 * 6 * 5];
        conus_pose motion;
        conus_pose pose;
        conus_pose moved_pose;
        double moved[16];
        for (size_t i = 0; i < sizeof labels / sizeof *labels; i++) {
            labels[i] = test_random(&seed, 0, 1) < 0.1 ? 1 + (uint32_t)(i % 4) : 0;
        }
        labels[0] = 1;
        const conus_volume_info grid = round % 2 ? scene_grid(&seed, dim) : scene_plain_grid(dim, NULL);
        conus_atlas *atlas = scene_parcellation(&grid, labels);
        double at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = test_random(&seed, -1000, 1000);
        }
        pose = scene_generic_pose(&seed, atlas);
        assert_ok(conus_pose_along(&motion, at, (const double[]){at[2], at[0], 500}, NULL));
        mat4_multiply(moved, motion.world_from_device, grid.world_from_voxel);
        mat4_multiply(moved_pose.world_from_device, motion.world_from_device, pose.world_from_device);
        const conus_volume_info other = scene_plain_grid(dim, moved);
        conus_atlas *turned = scene_parcellation(&other, labels);
        const conus_selector_options options = {.range = {1, 12}};
        conus_table *here = measure(atlas, &options, &pose, INFINITY);
        conus_table *there = measure(turned, &options, &moved_pose, INFINITY);
        assert_int_equal(conus_table_rows(here), conus_table_rows(there));
        for (size_t i = 0; i < conus_table_rows(here); i++) {
            size_t k = table_row_of(there, conus_table_objects(here)[i]);
            assert_near(row_at(here, i).distance, row_at(there, k).distance, 1e-9);
        }
        conus_table_destroy(here);
        conus_table_destroy(there);
        conus_atlas_destroy(atlas);
        conus_atlas_destroy(turned);
    }
}

/* Least distance of the point from a triangle a + u (b - a) + v (c - a): for each u the best v is known, and the rest
 * is convex in u. */
static long double triangle_distance(double corner[3][3], const long double point[3])
{
    long double low = 0;
    long double high = 1;
    long double distance = 0;
    for (int i = 0; i < 2 * 80; i++) {
        long double u[2] = {low + (high - low) / 3, high - (high - low) / 3};
        long double square[2];
        for (int k = 0; k < 2; k++) {
            long double dot = 0;
            long double along2 = 0;
            long double to[3];
            for (int a = 0; a < 3; a++) {
                long double c = (long double)corner[2][a] - corner[0][a];
                to[a] = corner[0][a] + u[k] * ((long double)corner[1][a] - corner[0][a]) - point[a];
                dot += c * to[a];
                along2 += c * c;
            }
            long double v = fminl(fmaxl(along2 > 0 ? -dot / along2 : 0, 0), 1 - u[k]);
            square[k] = 0;
            for (int a = 0; a < 3; a++) {
                long double d = to[a] + v * ((long double)corner[2][a] - corner[0][a]);
                square[k] += d * d;
            }
        }
        bool is_left = square[0] <= square[1];
        high = is_left ? u[1] : high;
        low = is_left ? low : u[0];
        distance = sqrtl(is_left ? square[0] : square[1]);
        i += high - low < 1e-14L ? 160 : 0;
    }
    return distance;
}

static double least_of_triangle(double corner[3][3], const struct needle *needle)
{
    long double low = needle->near;
    long double high = needle->far;
    long double least = 0;
    for (int i = 0; i < 90; i++) {
        long double t[2] = {low + (high - low) / 3, high - (high - low) / 3};
        long double distance[2];
        for (int k = 0; k < 2; k++) {
            long double point[3];
            for (int a = 0; a < 3; a++) {
                point[a] = needle->origin[a] + t[k] * needle->direction[a];
            }
            distance[k] = triangle_distance(corner, point);
        }
        bool is_left = distance[0] <= distance[1];
        high = is_left ? t[1] : high;
        low = is_left ? low : t[0];
        least = is_left ? distance[0] : distance[1];
    }
    return (double)least;
}

/* Triangles at random, one by one. */
static void triangles_are_as_far_as_a_search_says(void **state)
{
    (void)state;
    uint64_t seed = 55;
    size_t crossed = 0;
    for (int round = 0; round < 150; round++) {
        struct mesh mesh = mesh_scene_soup(&seed, 1, 6, 4);
        struct needle needle = {.near = test_random(&seed, -3, 3)};
        double corner[3][3];
        double point[3];
        double at[3];
        double depth;
        for (int a = 0; a < 3; a++) {
            needle.origin[a] = test_random(&seed, -6, 6);
            needle.direction[a] = test_random(&seed, -1, 1);
        }
        for (int a = 0; round % 3 == 0 && a < 3; a++) { /* at the triangle */
            const float *p = mesh.positions + a;
            needle.direction[a] = (double)(p[0] + p[3] + p[6]) / 3 - needle.origin[a];
        }
        assert_true(vec3_normalise(needle.direction, needle.direction));
        needle.far = needle.near + test_random(&seed, 0, 12);
        mesh_corners(corner, &mesh, 0);
        double distance = mesh_needle(&depth, point, &mesh, 0, &needle);
        assert_near(distance, least_of_triangle(corner, &needle), 1e-9);
        needle_point(at, &needle, depth);
        vec3_sub(at, at, point);
        assert_near(vec3_length(at), distance, 1e-9);
        assert_near((double)triangle_distance(corner, (const long double[]){point[0], point[1], point[2]}), 0, 1e-9);
        assert_true(depth >= needle.near && depth <= needle.far);
        crossed += distance == 0;
        mesh_finish(&mesh);
    }
    assert_true(crossed > 10 && crossed < 100);
}

/* The tree finds the same as a loop over all triangles. */
static void surfaces_are_as_far_as_their_nearest_triangle(void **state)
{
    (void)state;
    uint64_t seed = 89;
    for (int round = 0; round < 60; round++) {
        conus_atlas *atlas = mesh_scene_atlas();
        conus_selector *selector = NULL;
        conus_pose pose;
        double at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = test_random(&seed, -15, 15);
        }
        mesh_scene_add_soups(atlas, &seed);
        assert_ok(conus_pose_along(&pose, at, (const double[]){-at[1], 2 - at[0], 1 - at[2]}, NULL));
        const struct needle needle = needle_of(&pose, 2, 14);
        double start[3];
        needle_point(start, &needle, 2);
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        const struct clearance *taken = take(selector, NULL, &needle, 1e3);
        for (uint32_t object = 1; object <= atlas->object_count; object++) {
            const struct mesh *mesh = atlas_object_mesh(atlas, object);
            const struct clearance_found *found = &taken->found[object];
            double least = INFINITY;
            double first = INFINITY;
            for (size_t triangle = 0; triangle < mesh->triangle_count; triangle++) {
                double point[3];
                double depth;
                double distance = mesh_needle(&depth, point, mesh, triangle, &needle);
                first = distance < least || (distance == least && depth < first) ? depth : first;
                least = fmin(least, distance);
            }
            bool is_inside = mesh->shape.closed && fabs(mesh_winding(mesh, start)) >= 0.5;
            assert_near(found->distance, is_inside ? 0 : least, 0);
            assert_near(found->depth, is_inside ? 2 : first, 0);
        }
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
}

/* A closed box from (-3, -2, -1) to (3, 2, 1) as a surface: from inside, into it, past it. An open surface has no
 * inside. */
static void a_surface_is_entered_or_begun_in(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((const double[]){-3, -2, -1}, (const double[]){3, 2, 1});
    struct mesh sheet = {0};
    assert_ok(mesh_init(&sheet, 3, 1));
    const float corners[9] = {20, -5, -5, 20, 5, -5, 20, 0, 8};
    memcpy(sheet.positions, corners, sizeof corners);
    sheet.triangles[1] = 1;
    sheet.triangles[2] = 2;
    mesh_scene_add(atlas, &box);
    mesh_scene_add(atlas, &sheet);
    const struct {
        double at[3], along[3], range[2];
        struct wanted wanted[2];
    } cases[] = {
        {{-10, 0.1, 0.2}, {1, 0, 0}, {0, 40}, {{1, 0, 7, {-3, 0.1, 0.2}}, {2, 0, 30, {20, 0.1, 0.2}}}},
        {{-10, 0.1, 0.2}, {1, 0, 0}, {8, 11}, {{1, 0, 8, {-2, 0.1, 0.2}}, {2, 19, 11, {20, 0.1, 0.2}}}},
        {{-10, 0.1, 0.2}, {1, 0, 0}, {0, 4}, {{1, 3, 4, {-3, 0.1, 0.2}}, {2, 26, 4, {20, 0.1, 0.2}}}},
        {{21, 0.1, 0.2}, {1, 0, 0}, {0, 4}, {{2, 1, 0, {20, 0.1, 0.2}}, {1, 18, 0, {3, 0.1, 0.2}}}},
        /* past the edge x = 3, z = 1, along y */
        {{6, -9, 5}, {0, 1, 0}, {0, 9}, {{1, 5, 7, {3, -2, 1}}, {2, 14, 9 - 15.0 / 13, {20, -15.0 / 13, 5}}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double *at = cases[i].at;
        const double *to = cases[i].along;
        const conus_pose pose = along(at[0], at[1], at[2], to[0], to[1], to[2]);
        const conus_selector_options options = {.range = {cases[i].range[0], cases[i].range[1]}};
        conus_table *clearances = measure(atlas, &options, &pose, 100);
        assert_int_equal(conus_table_rows(clearances), 2);
        for (size_t k = 0; k < 2; k++) {
            const struct wanted row = row_at(clearances, k);
            check_row(&row, &cases[i].wanted[k], 1e-12);
        }
        conus_table_destroy(clearances);
    }
    conus_atlas_destroy(atlas);
}

/* A box without its lid at x = 3: as far as its walls, from within and from outside. */
static void a_surface_with_holes_has_no_inside(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((const double[]){-3, -2, -1}, (const double[]){3, 2, 1});
    box.triangle_count -= 2;
    mesh_scene_add(atlas, &box);
    const conus_selector_options options = {.range = {0, 1}};
    const struct wanted within = {1, 0.75, 0, {-2, 0, 1}};
    const struct wanted without = {1, sqrt(1 + 0.75 * 0.75), 0, {3, 0, 1}};
    for (int i = 0; i < 2; i++) {
        const conus_pose pose = along(i ? 4 : -2, 0, 0.25, 1, 0, 0);
        conus_table *clearances = measure(atlas, &options, &pose, 100);
        const struct wanted row = row_at(clearances, 0);
        check_row(&row, i ? &without : &within, 1e-12);
        conus_table_destroy(clearances);
    }
    conus_atlas_destroy(atlas);
}

/* Half a nanometre from the face x = 11 of the cell counts as touching, two do not. */
static void what_rounding_may_make_of_touching_is_touching(void **state)
{
    (void)state;
    conus_atlas *atlas = one_cell();
    const double beside[2] = {0.5e-9, 2e-9};
    for (int i = 0; i < 2; i++) {
        const conus_pose pose = along(11 + beside[i], 0, 30, 0, 1, 0);
        conus_table *clearances = measure(atlas, &(conus_selector_options){.range = {0, 50}}, &pose, 1);
        double distance = table_number_at(clearances, "distance_mm", 0);
        assert_near(distance, i ? beside[i] : 0, i ? 1e-14 : 0);
        conus_table_destroy(clearances);
    }
    conus_atlas_destroy(atlas);
}

/* Two closed balls of 256 x 256 quadrilaterals, which are inscribed: within R (1 - cos(pi/256)) of the true ones. One
 * winds the other way. */
static void balls_are_as_far_as_their_radius_says(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh outwards = mesh_scene_sphere((const double[]){0, 0, 0}, 10, 256, 256);
    struct mesh inwards = mesh_scene_sphere((const double[]){0, 40, 0}, 10, 256, 256);
    mesh_scene_turn(&inwards);
    mesh_scene_add(atlas, &outwards);
    mesh_scene_add(atlas, &inwards);
    double slack = 10 * (1 - cos(MATH3_PI / 256));
    const conus_pose pose = along(-30, 16, 1, 1, 0, 0);
    conus_table *clearances = measure(atlas, &(conus_selector_options){.range = {0, 60}}, &pose, 20);
    assert_int_equal(conus_table_rows(clearances), 2);
    assert_near(table_number_at(clearances, "distance_mm", 0), sqrt(257) - 10, slack);
    assert_near(table_number_at(clearances, "depth_mm", 0), 30, 0.3);
    assert_near(table_number_at(clearances, "distance_mm", 1), sqrt(577) - 10, slack);
    conus_table_destroy(clearances);
    const conus_pose inside = along(1, 42, 3, 0, -1, 0);
    clearances = measure(atlas, &(conus_selector_options){.range = {1, 100}}, &inside, 20);
    assert_int_equal(conus_table_objects(clearances)[0], 2);
    assert_near(table_number_at(clearances, "depth_mm", 0), 1, 0);
    assert_near(table_number_at(clearances, "distance_mm", 1), 0, 0);
    assert_near(table_number_at(clearances, "depth_mm", 1), 42 - sqrt(90), 2 * slack);
    conus_table_destroy(clearances);
    conus_atlas_destroy(atlas);
}

/* Lines along x at z = 30, of 0.5 mm (tract_lines_atlas): bundle 1 has y = 0 and y = 3, bundle 2 y = 100. */
static void tubes_are_as_far_as_their_lines_less_the_radius(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    const struct {
        double at[3], along[3], range[2];
        struct wanted wanted[2];
    } cases[] = {
        /* across, 4 mm above; into the tube; begins in it */
        {{1, -20, 34}, {0, 1, 0}, {0, 60}, {{1, 3.5, 20, {1, 0, 30.5}}, {2, sqrt(3616) - 0.5, 60, {0}}}},
        {{1, 0, 0}, {0, 0, 1}, {0, 60}, {{1, 0, 29.5, {1, 0, 29.5}}, {2, 99.5, 30, {1, 99.5, 30}}}},
        {{1, 0, 0}, {0, 0, 1}, {29.75, 60}, {{1, 0, 29.75, {1, 0, 29.75}}, {2, 99.5, 30, {1, 99.5, 30}}}},
        {{1, 0, 0}, {0, 0, 1}, {0, 20}, {{1, 9.5, 20, {1, 0, 29.5}}, {2, sqrt(10100) - 0.5, 20, {0}}}},
        /* along them, from before their ends at x = -50: from there on */
        {{-60, 0, 32}, {1, 0, 0}, {0, 200}, {{1, 1.5, 10, {-50, 0, 30.5}}, {2, sqrt(10004) - 0.5, 10, {0}}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double *at = cases[i].at;
        const double *to = cases[i].along;
        const conus_pose pose = along(at[0], at[1], at[2], to[0], to[1], to[2]);
        const conus_selector_options options = {.range = {cases[i].range[0], cases[i].range[1]}};
        conus_table *clearances = measure(atlas, &options, &pose, INFINITY);
        assert_int_equal(conus_table_rows(clearances), 2);
        for (size_t k = 0; k < 2; k++) {
            const struct wanted row = row_at(clearances, k);
            struct wanted wanted = cases[i].wanted[k];
            if (wanted.near[2] == 0) { /* its distance and depth say enough */
                memcpy(wanted.near, row.near, sizeof wanted.near);
            }
            check_row(&row, &wanted, 1e-12);
        }
        conus_table_destroy(clearances);
    }
    conus_atlas_destroy(atlas);
}

/* Lower bound for the distance of a segment from line[0] to line[1]: its middle's distance, less half of its length. */
static double distance_of_middle(double line[3][3], const struct needle *needle)
{
    double half[3];
    double foot[3];
    vec3_sub(half, line[1], line[0]);
    vec3_scale(half, half, 0.5);
    vec3_add_scaled(foot, line[0], 1, half);
    vec3_sub(foot, foot, needle->origin);
    double t = fmin(fmax(vec3_dot(foot, needle->direction), needle->near), needle->far);
    vec3_add_scaled(foot, foot, -t, needle->direction);
    return vec3_length(foot) - vec3_length(half);
}

/* Random streamlines, some of one point, in groups: against every segment, by a search along the needle. */
static void bundles_are_as_far_as_their_nearest_tube(void **state)
{
    (void)state;
    enum { LINES = 60, POINTS = 9 };
    static double points[LINES][POINTS][3];
    uint64_t seed = 144;
    for (int round = 0; round < 20; round++) {
        struct tract_builder builder;
        conus_atlas *atlas = NULL;
        uint32_t members[2][LINES];
        size_t counts[2] = {0};
        double radius = test_random(&seed, 0.1, 1);
        tract_begin(&builder);
        builder.made.radius = radius;
        for (uint32_t k = 0; k < LINES; k++) {
            double at[3] = {test_random(&seed, -30, 30), test_random(&seed, -30, 30), test_random(&seed, -30, 30)};
            for (int p = 0; p < (k % 7 ? POINTS : 1); p++) {
                for (int a = 0; a < 3; a++) {
                    at[a] = (double)(float)(at[a] + test_random(&seed, -2, 3));
                    points[k][p][a] = at[a];
                }
                tract_add_point(&builder, at);
            }
            tract_end_streamline(&builder);
            for (int group = 0; group < 2; group++) {
                if (test_random(&seed, 0, 1) < 0.3) {
                    members[group][counts[group]++] = k;
                }
            }
        }
        if (round % 2) {
            tract_add_group(&builder.made, "one", members[0], counts[0]);
            tract_add_group(&builder.made, "other", members[1], counts[1]);
        }
        assert_ok(atlas_create_empty(&atlas, "none"));
        assert_ok(atlas_add_tractogram(atlas, &builder.made, "rest"));
        const conus_pose pose =
            along(test_random(&seed, -20, 20), test_random(&seed, -20, 20), -20, test_random(&seed, -1, 1), 0.3, 1);
        const struct needle needle = needle_of(&pose, 3, 33);
        conus_table *clearances =
            measure(atlas, &(conus_selector_options){.range = {3, 33}}, &pose, round % 3 ? INFINITY : 5);
        for (uint32_t object = 1; object <= atlas->object_count; object++) {
            const struct tract_group *group = atlas_bundle_group(atlas, object);
            size_t count = tract_group_count(group, &atlas->tractograms[0]);
            double least = INFINITY;
            for (size_t i = 0; i < count; i++) {
                uint32_t k = tract_group_member(group, i);
                for (int p = 0; p < (k % 7 ? POINTS - 1 : 1); p++) {
                    double line[3][3]; /* a triangle without width */
                    memcpy(line[0], points[k][p], sizeof line[0]);
                    memcpy(line[1], points[k][p + (k % 7 > 0)], sizeof line[1]);
                    memcpy(line[2], line[0], sizeof line[2]);
                    if (least > 0 && distance_of_middle(line, &needle) - radius < least) {
                        least = fmin(least, least_of_triangle(line, &needle) - radius);
                    }
                }
            }
            size_t found = table_row_of(clearances, object);
            assert_int_equal(found < conus_table_rows(clearances), round % 3 || least <= 5);
            if (found < conus_table_rows(clearances)) {
                const struct wanted row = row_at(clearances, found);
                double offset[3];
                assert_near(row.distance, fmax(least, 0), 1e-9);
                table_point_at(offset, clearances, "", found);
                vec3_sub(offset, offset, row.near);
                assert_near(vec3_length(offset), row.distance, 1e-9);
            }
        }
        conus_table_destroy(clearances);
        conus_atlas_destroy(atlas);
    }
}

/* Cells 1 and 2 of 1 mm side by side along x, from 0.5 to 2.5, below a needle along x: cell 2 from 1.5 on. */
static void the_radius_is_taken_off(void **state)
{
    (void)state;
    static const size_t dim[3] = {2, 1, 1};
    const double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1};
    const conus_volume_info grid = scene_plain_grid(dim, m);
    conus_atlas *atlas = scene_parcellation(&grid, (const uint32_t[]){1, 2});
    const conus_pose pose = along(-1, 0, 2, 1, 0, 0);
    const conus_selector_options thick = {.range = {0, 9}, .radius = 0.75};
    conus_table *clearances = measure(atlas, &thick, &pose, 0.75);
    assert_int_equal(conus_table_rows(clearances), 2);
    assert_near(table_number_at(clearances, "clearance_mm", 0), 0.75, 0);
    assert_near(table_number_at(clearances, "depth_mm", 0), 1.5, 0);
    assert_string_equal(table_text_at(clearances, "kind", 0), "area");
    assert_int_equal(conus_table_objects(clearances)[1], 2);
    assert_near(table_number_at(clearances, "depth_mm", 1), 2.5, 0);
    conus_table_destroy(clearances);
    clearances = measure(atlas, &thick, &pose, 0.7499);
    assert_int_equal(conus_table_rows(clearances), 0);
    conus_table_destroy(clearances);
    /* hidden objects and a context are left out */
    uint64_t seed = 1;
    scene_add_blockers(atlas, &seed, (const size_t[]){5, 5, 5}, 0.9);
    assert_ok(conus_atlas_set_hidden(atlas, (const bool[]){false, true, false}));
    clearances = measure(atlas, &thick, &pose, INFINITY);
    assert_int_equal(conus_table_rows(clearances), 1);
    assert_int_equal(conus_table_objects(clearances)[0], 2);
    conus_table_destroy(clearances);
    conus_atlas_destroy(atlas);
}

/* With the index made before the selector was shared, or with a separate one. */
static void a_shared_selector_measures_as_well(void **state)
{
    (void)state;
    uint64_t seed = 233;
    conus_atlas *atlas = scene_atlas(&seed, 10, 0);
    mesh_scene_add_soups(atlas, &seed);
    const conus_pose pose = scene_generic_pose(&seed, atlas);
    conus_table *exact = measure(atlas, NULL, &pose, INFINITY);
    assert_true(conus_table_rows(exact) >= 3);
    for (int made_before = 0; made_before < 2; made_before++) {
        conus_selector *selector = NULL;
        conus_selector *shared = NULL;
        conus_table *clearances = NULL;
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        assert_ok(made_before ? selector_prepare_clearance(selector) : CONUS_OK);
        assert_ok(conus_selector_share(&shared, selector));
        assert_ok(conus_clearance(&clearances, shared, &pose, INFINITY));
        assert_same_tables(clearances, exact);
        conus_table_destroy(clearances);
        conus_selector_destroy(shared);
        conus_selector_destroy(selector);
    }
    conus_table_destroy(exact);
    conus_atlas_destroy(atlas);
}

static void what_cannot_be_measured_is_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = one_cell();
    conus_atlas *empty = mesh_scene_atlas();
    conus_selector *selector = NULL;
    conus_table *clearances = NULL;
    conus_pose pose = along(0, 0, 0, 1, 0, 0);
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_fails(conus_clearance(&clearances, selector, &pose, -1), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "within: -1 mm, allowed are 0 and more");
    assert_fails(conus_clearance(&clearances, selector, &pose, NAN), CONUS_ERROR_ARGUMENT);
    pose.world_from_device[0] = NAN;
    assert_fails(conus_clearance(&clearances, selector, &pose, 1), CONUS_ERROR_ARGUMENT);
    assert_null(clearances);
    conus_selector_destroy(selector);
    pose = along(0, 0, 0, 1, 0, 0);
    clearances = measure(empty, NULL, &pose, INFINITY); /* nothing is near */
    assert_int_equal(conus_table_rows(clearances), 0);
    conus_table_destroy(clearances);
    clearances = measure(atlas, NULL, &pose, 0); /* nothing is so near */
    assert_int_equal(conus_table_rows(clearances), 0);
    conus_table_destroy(clearances);
    conus_atlas_destroy(atlas);
    conus_atlas_destroy(empty);
}

static conus_status make_clearances(void *data)
{
    const conus_pose pose = along(-10, 0.1, 0.2, 1, 0, 0);
    conus_selector *selector = NULL;
    conus_table *clearances = NULL;
    conus_status status = conus_selector_create(&selector, data, NULL);
    status = status ? status : conus_clearance(&clearances, selector, &pose, INFINITY);
    conus_table_destroy(clearances);
    conus_selector_destroy(selector);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    conus_atlas *cells = one_cell();
    struct mesh box = mesh_scene_box((const double[]){-3, -2, -1}, (const double[]){3, 2, 1});
    mesh_scene_add(cells, &box);
    test_every_allocation(make_clearances, atlas);
    test_every_allocation(make_clearances, cells);
    conus_atlas_destroy(atlas);
    conus_atlas_destroy(cells);
}

TEST_GROUP(clearance)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_as_far_as_its_nearest_part),
        cmocka_unit_test(volumes_are_as_far_as_their_nearest_cell),
        cmocka_unit_test(a_point_is_as_far_as_a_ball_says),
        cmocka_unit_test(an_answer_does_not_depend_on_the_question),
        cmocka_unit_test(distances_fall_with_the_far_end),
        cmocka_unit_test(motion_changes_nothing),
        cmocka_unit_test(triangles_are_as_far_as_a_search_says),
        cmocka_unit_test(surfaces_are_as_far_as_their_nearest_triangle),
        cmocka_unit_test(a_surface_is_entered_or_begun_in),
        cmocka_unit_test(a_surface_with_holes_has_no_inside),
        cmocka_unit_test(what_rounding_may_make_of_touching_is_touching),
        cmocka_unit_test(balls_are_as_far_as_their_radius_says),
        cmocka_unit_test(tubes_are_as_far_as_their_lines_less_the_radius),
        cmocka_unit_test(bundles_are_as_far_as_their_nearest_tube),
        cmocka_unit_test(the_radius_is_taken_off),
        cmocka_unit_test(a_shared_selector_measures_as_well),
        cmocka_unit_test(what_cannot_be_measured_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
