/* SPDX-License-Identifier: BSD-3-Clause */
/* The census of Eq. 10: the fast walk finds the voxels of the predicate, each once and in order. */
#include "base/math3.h"
#include "base/memory.h"
#include "scene.h"
#include "selection/census.h"
#include "test.h"

#include <string.h>

/* What a walk has to call, in order. */
struct expected {
    const struct region *region;
    const struct volume *volume;
    size_t next; /* linear index of the first voxel that was not told about yet */
    size_t found;
};

static bool voxel_is_in(const struct expected *expected, size_t voxel)
{
    const size_t *dim = expected->volume->info.dim;
    double p[3] = {(double)(voxel % dim[0]), (double)(voxel / dim[0] % dim[1]), (double)(voxel / dim[0] / dim[1])};
    mat4_point(p, expected->volume->info.world_from_voxel, p);
    return region_has(expected->region, p);
}

static void check_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct expected *expected = user;
    const size_t *dim = volume->info.dim;
    assert_ptr_equal(volume, expected->volume);
    assert_true(count > 0 && at[0] + count <= dim[0] && at[1] < dim[1] && at[2] < dim[2]);
    size_t first = at[0] + dim[0] * (at[1] + dim[1] * at[2]);
    assert_true(first >= expected->next);
    for (; expected->next < first; expected->next++) {
        assert_false(voxel_is_in(expected, expected->next));
    }
    for (; expected->next < first + count; expected->next++) {
        assert_true(voxel_is_in(expected, expected->next));
    }
    expected->found += count;
}

static size_t check_walk(const struct region *region, const struct volume *volume)
{
    struct expected expected = {region, volume, 0, 0};
    census_walk(region, volume, check_row, &expected);
    for (; expected.next < volume->voxel_count; expected.next++) {
        assert_false(voxel_is_in(&expected, expected.next));
    }
    return expected.found;
}

/* A region with the cone's place; its borders are often at whole and half millimetres. */
static struct region random_region(uint64_t *state, const struct cone *cone)
{
    struct region region;
    double size = pow(10, test_random(state, -1, 2));
    size = test_random(state, 0, 1) < 0.5 ? ceil(2 * size) / 2 : size;
    if (test_random(state, 0, 1) < 0.2) {
        region_ball(&region, cone->pose.world_from_device + 12, size);
        return region;
    }
    region_from_cone(&region, cone);
    if (test_random(state, 0, 1) < 0.4) {
        region.shape = REGION_CYLINDER;
        region.radius = size;
        region.slope = region.sine = 0;
        region.cosine = 1;
    }
    if (test_random(state, 0, 1) < 0.4) {
        region.near = floor(test_random(state, 0, 10));
        region.far = test_random(state, 0, 1) < 0.5 ? region.near + floor(test_random(state, 0, 30)) : INFINITY;
    }
    return region;
}

static double random_angle(uint64_t *state)
{
    static const double angles[] = {1e-6, 1, 53.13010235415598, 60, 90, 120, 179, 179.999999};
    size_t pick = (size_t)test_random(state, 0, 16);
    return radians_from_degrees(pick < 8 ? angles[pick] : test_random(state, 0.1, 179.9));
}

static void test_walk_is_predicate(void **unused)
{
    (void)unused;
    uint64_t state = 1;
    size_t found = 0;
    for (int scene = 0; scene < 150; scene++) {
        conus_atlas *atlas = scene_atlas(&state, 24, 0);
        for (int i = 0; i < 30; i++) {
            struct cone cone = {.pose = scene_pose(&state, atlas), .angle = random_angle(&state), .resolution = 16};
            cone.aperture = (conus_aperture)(i % 3 == 0);
            struct region region = random_region(&state, &cone);
            found += check_walk(&region, &atlas->volumes[0]);
        }
        conus_atlas_destroy(atlas);
    }
    assert_true(found > 1000000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_walk_is_predicate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
