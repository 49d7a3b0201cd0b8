/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 21: how far a needle stays from objects. Cells, triangles and tubes in closed form, and against a search that
 * knows no more than how far a point is from a cell, a triangle or a polyline. */
#include "atlas/atlas.h"
#include "atlas/bundles.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/selector.h"
#include "selection/study/study.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static conus_clearances *measure(const conus_atlas *atlas, const conus_selector_options *options,
                                 const conus_pose *pose, double within)
{
    conus_selector *selector = NULL;
    conus_clearances *clearances = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_clearances_create(&clearances, selector, pose, within));
    conus_selector_destroy(selector);
    return clearances;
}

static conus_pose along(double x, double y, double z, double dx, double dy, double dz)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (const double[]){x, y, z}, (const double[]){dx, dy, dz}, NULL));
    return pose;
}

/* A row that is known: distance, depth, and the nearest point. */
struct wanted {
    uint32_t object;
    double distance, depth;
    double near[3];
};

static void check_row(const conus_clearance *row, const struct wanted *wanted, double tolerance)
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
        /* looks away */
        {{10, 20, 40}, {0, 0, 1}, {0, 0}, {1, 7, 0, {10, 20, 33}}},
    };
    conus_atlas *atlas = one_cell();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double *at = cases[i].at;
        const double *to = cases[i].along;
        const conus_pose pose = along(at[0], at[1], at[2], to[0], to[1], to[2]);
        const conus_selector_options options = {.range = {cases[i].range[0], cases[i].range[1]}};
        conus_clearances *clearances = measure(atlas, &options, &pose, 100);
        assert_int_equal(conus_clearances_count(clearances), 1);
        check_row(conus_clearances_clearance(clearances, 0), &cases[i].wanted, 1e-12);
        conus_clearances_destroy(clearances);
    }
    conus_atlas_destroy(atlas);
}

/* How far `point` is from a cell, by the offsets x along its edges, each found in turn while the others are held: the
 * function is convex. Takes nothing of the library but the matrix. */
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

struct cell {
    const struct volume *volume;
    double voxel[3];
};

static long double distance_at(const struct cell *cell, const struct needle *needle, long double t)
{
    long double point[3];
    for (int a = 0; a < 3; a++) {
        point[a] = needle->origin[a] + t * needle->direction[a];
    }
    return cell_distance(cell->volume, cell->voxel, point);
}

/* The least distance of a cell by ternary search: it is convex along the needle. */
static double least_of_cell(const struct cell *cell, const struct needle *needle)
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

/* Cells of `object` that could be as near as `least`, by their centres and half diagonals; the least of them. */
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
                const struct cell cell = {
                    volume, {(double)(i % dim[0]), (double)(i / dim[0] % dim[1]), (double)(i / dim[0] / dim[1])}};
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
        conus_clearances *clearances = measure(atlas, &(conus_selector_options){.range = {near, far}}, &pose, INFINITY);
        size_t shown = 0;
        for (size_t i = 0; i < atlas->object_count; i++) {
            shown += atlas->objects[i].voxels > 0;
        }
        assert_int_equal(conus_clearances_count(clearances), shown);
        for (size_t i = 0; i < conus_clearances_count(clearances); i++) {
            const conus_clearance *row = conus_clearances_clearance(clearances, i);
            double offset[3];
            double slack = 1e-9 + 1e-13 * vec3_length(needle.origin);
            assert_near(row->distance, least_of_object(atlas, row->object, &needle, row->distance), slack);
            vec3_sub(offset, row->at, row->near);
            assert_near(vec3_length(offset), row->distance, slack);
            needle_point(offset, &needle, row->depth);
            vec3_sub(offset, offset, row->at);
            assert_near(vec3_length(offset), 0, 1e-12);
            assert_true(row->depth >= near && row->depth <= far);
            apart += row->distance > 0;
        }
        conus_clearances_destroy(clearances);
        conus_atlas_destroy(atlas);
    }
    assert_true(apart > 200);
}

TEST_GROUP(clearance)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_as_far_as_its_nearest_part),
        cmocka_unit_test(volumes_are_as_far_as_their_nearest_cell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
