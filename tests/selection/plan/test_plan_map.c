/* SPDX-License-Identifier: BSD-3-Clause */
/* Maps of plans: their answers, against distances from all cells, one by one, and lengths in all cells. */
#include "base/geometry/math3.h"
#include "scene.h"
#include "selection/plan/plan.h"
#include "test.h"

#include <math.h>
#include <string.h>

enum { EDGE = 7, AROUND = EDGE + 2, POINTS = 300, NEEDLES = 50, SAMPLES = 60 };
static const uint32_t HAS[3] = {0, 1, 0};

/* Blobs of objects 1 and 2 on a turned and flipped grid, with edges of different lengths. */
static conus_atlas *blobs(uint64_t *seed)
{
    conus_volume_info grid = scene_grid(seed, (const size_t[]){EDGE, EDGE, EDGE});
    double *m = grid.world_from_voxel;
    uint32_t labels[EDGE * EDGE * EDGE];
    vec3_cross(m + 8, m, m + 4);
    vec3_cross(m + 4, m + 8, m);
    for (int a = 0; a < 3; a++) {
        vec3_normalise(m + 4 * a, m + 4 * a);
        vec3_scale(m + 4 * a, m + 4 * a, test_random(seed, 0.7, 1.4));
    }
    for (size_t i = 0; i < EDGE * EDGE * EDGE; i++) {
        const size_t at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double away[3] = {(double)at[0] - 3.2, (double)at[1] - 3, (double)at[2] - 1.9};
        double distance = vec3_length(away) + test_random(seed, -0.6, 0.6);
        labels[i] = distance < 2.4 ? 1 : distance < 3.2 ? 2 : 0;
    }
    return scene_parcellation(&grid, labels);
}

/* Number `index` of the cells of the grid and of a layer around it: its voxel, and whether it is object 1. */
static bool take_cell(double cell[3], const struct volume *volume, int index)
{
    int at[3] = {index % AROUND - 1, index / AROUND % AROUND - 1, index / AROUND / AROUND - 1};
    bool is_in = true;
    for (int a = 0; a < 3; a++) {
        cell[a] = at[a];
        is_in = is_in && at[a] >= 0 && at[a] < EDGE;
    }
    return is_in && volume_object(volume, (size_t)at[0] + EDGE * ((size_t)at[1] + EDGE * (size_t)at[2])) == 1;
}

/* mm from a point, in voxels, to the cells of object 1, or to all others. */
static double distance_of(const struct volume *volume, const double at[3], bool outside)
{
    double best = INFINITY;
    for (int a = 0; a < 3 && outside; a++) {
        best = fabs(at[a] - (EDGE - 1) / 2.0) > AROUND / 2.0 ? 0 : best; /* beyond the layer */
    }
    for (int index = 0; index < AROUND * AROUND * AROUND; index++) {
        double cell[3];
        if (take_cell(cell, volume, index) != outside) {
            double away[3];
            for (int a = 0; a < 3; a++) {
                away[a] = fmax(fabs(at[a] - cell[a]) - 0.5, 0) * vec3_length(volume->info.world_from_voxel + 4 * a);
            }
            best = fmin(best, vec3_length(away));
        }
    }
    return best;
}

/* mm of a needle in the cells of object 1. */
static double length_in(const struct volume *volume, const struct needle *needle)
{
    double sum = 0;
    double at[3];
    double step[3];
    mat4_point(at, volume->voxel_from_world, needle->origin);
    mat4_direction(step, volume->voxel_from_world, needle->direction);
    for (int index = 0; index < AROUND * AROUND * AROUND; index++) {
        double cell[3];
        if (take_cell(cell, volume, index)) {
            double entry = needle->near;
            double exit = needle->far;
            for (int a = 0; a < 3; a++) {
                double ends[2] = {(cell[a] - 0.5 - at[a]) / step[a], (cell[a] + 0.5 - at[a]) / step[a]};
                entry = fmax(entry, fmin(ends[0], ends[1]));
                exit = fmin(exit, fmax(ends[0], ends[1]));
            }
            sum += fmax(exit - entry, 0);
        }
    }
    return sum;
}

static void check_points(const struct volume *volume, const struct plan_map *map, bool outside, uint64_t *seed)
{
    double widest = 0;
    for (int i = 0; i < POINTS; i++) {
        double at[3] = {test_random(seed, -2, 8), test_random(seed, -2, 8), test_random(seed, -2, 8)};
        double bounds[2];
        double distance = distance_of(volume, at, outside);
        plan_map_bounds(bounds, map, at);
        assert_true(bounds[0] < distance && distance < bounds[1]);
        widest = fmax(widest, bounds[1] - bounds[0]);
    }
    assert_true(widest < 3); /* half diagonals of 1.22 mm at most on either side, and a unit */
}

static struct needle random_needle(const struct volume *volume, uint64_t *seed)
{
    struct needle needle = {.near = test_random(seed, 0, 2), .far = test_random(seed, 3, 12)};
    double from[3] = {test_random(seed, -4, 10), test_random(seed, -4, 10), test_random(seed, -4, 10)};
    double to[3] = {test_random(seed, -2, 8), test_random(seed, -2, 8), test_random(seed, -2, 8)};
    mat4_point(needle.origin, volume->info.world_from_voxel, from);
    mat4_point(to, volume->info.world_from_voxel, to);
    vec3_sub(to, to, needle.origin);
    vec3_normalise(needle.direction, to);
    return needle;
}

/* Compares the maps' answers about needles with distances from the structure's cells or, if `outside`, from the other
 * cells. */
static void check_needles(const struct volume *volume, const struct plan_map *map, bool outside, uint64_t *seed)
{
    int told[3] = {0};
    for (int i = 0; i < NEEDLES; i++) {
        struct needle needle = random_needle(volume, seed);
        double wanted = test_random(seed, 0.3, 2);
        double step = (needle.far - needle.near) / SAMPLES;
        double least = INFINITY;
        double left = 0;
        for (int s = 0; s < SAMPLES; s++) {
            double at[3];
            needle_point(at, &needle, needle.near + (s + 0.5) * step);
            mat4_point(at, volume->voxel_from_world, at);
            double distance = distance_of(volume, at, outside);
            least = fmin(least, distance);
            left += distance >= wanted + step ? step : 0; /* so all of it is, from sample to sample */
        }
        if (outside) {
            double length = length_in(volume, &needle);
            double told_length = plan_map_inside(map, &needle);
            assert_true(told_length == -INFINITY ? length == 0 : fabs(told_length - length) < 1e-6);
            assert_true(plan_map_most(map, &needle, needle.near, needle.far, wanted) >= left);
            assert_true(plan_map_most(map, &needle, needle.near, needle.far, 4) == 0);
        } else {
            int farther = plan_map_is_farther(map, &needle, wanted);
            told[farther + 1]++;
            assert_true(farther == 0 || (farther > 0 ? least > wanted : least - step < wanted));
        }
    }
    assert_true(outside || (told[0] > 5 && told[2] > 5));
}

static void maps_agree_with_the_cells(void **state)
{
    (void)state;
    uint64_t seed = 22;
    for (int trial = 0; trial < (int)test_trials(6); trial++) {
        conus_atlas *atlas = blobs(&seed);
        struct clearance_index *index = NULL;
        assert_ok(clearance_index_create(&index, atlas));
        for (int outside = 0; outside < 2; outside++) {
            struct plan_map *map = NULL;
            assert_ok(plan_map_create(&map, index, atlas, &atlas->volumes[0], HAS, outside));
            assert_non_null(map);
            check_points(&atlas->volumes[0], map, outside, &seed);
            check_needles(&atlas->volumes[0], map, outside, &seed);
            plan_map_destroy(map);
        }
        clearance_index_destroy(index);
        conus_atlas_destroy(atlas);
    }
}

/* A needle along a face may be on either side of it; a grid whose axes are not perpendicular has no map. */
static void places_that_maps_do_not_decide(void **state)
{
    (void)state;
    uint64_t seed = 3;
    conus_atlas *atlas = blobs(&seed);
    struct volume *volume = &atlas->volumes[0];
    struct clearance_index *index = NULL;
    struct plan_map *map = NULL;
    struct needle needle = {.far = 10};
    assert_ok(clearance_index_create(&index, atlas));
    assert_ok(plan_map_create(&map, index, atlas, volume, HAS, true));
    mat4_point(needle.origin, volume->info.world_from_voxel, (const double[]){-2, 3.5, 2});
    vec3_normalise(needle.direction, volume->info.world_from_voxel);
    assert_true(isnan(plan_map_inside(map, &needle)));
    plan_map_destroy(map);
    vec3_add_scaled(volume->info.world_from_voxel, volume->info.world_from_voxel, 0.1,
                    volume->info.world_from_voxel + 4);
    assert_ok(plan_map_create(&map, index, atlas, volume, HAS, true));
    assert_null(map);
    clearance_index_destroy(index);
    conus_atlas_destroy(atlas);
}

struct making {
    const struct clearance_index *index;
    const conus_atlas *atlas;
};

static conus_status attempt(void *data)
{
    const struct making *making = data;
    struct plan_map *map = NULL;
    conus_status status = plan_map_create(&map, making->index, making->atlas, &making->atlas->volumes[0], HAS, false);
    plan_map_destroy(map);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    uint64_t seed = 4;
    conus_atlas *atlas = blobs(&seed);
    struct clearance_index *index = NULL;
    assert_ok(clearance_index_create(&index, atlas));
    test_every_allocation(attempt, &(struct making){index, atlas});
    clearance_index_destroy(index);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(plan_map)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_agree_with_the_cells),
        cmocka_unit_test(places_that_maps_do_not_decide),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
