/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/math3.h"
#include "oracle_traversal.h"
#include "scene.h"
#include "selection/engine_rays.h"
#include "test.h"

#include <string.h>

static struct cone random_cone(uint64_t *state, const conus_atlas *atlas)
{
    struct cone cone = {.pose = scene_pose(state, atlas)};
    cone.angle =
        radians_from_degrees(test_random(state, 0, 1) < 0.5 ? test_random(state, 1, 20) : test_random(state, 1, 170));
    cone.resolution = 1 + (uint32_t)test_random(state, 0, test_random(state, 0, 1) < 0.2 ? 64 : 17);
    return cone;
}

static void assert_same_pixel(const struct evidence *got, const struct evidence *wanted, size_t pixel)
{
    bool same = got->object[pixel] == wanted->object[pixel] && got->voxel[pixel] == wanted->voxel[pixel] &&
                (got->distance[pixel] == wanted->distance[pixel]);
    if (!same) {
        fail_msg("pixel %zu of %u x %u: object %u, voxel %llu, %.17g mm; wanted %u, %llu, %.17g", pixel,
                 got->resolution, got->resolution, got->object[pixel], (unsigned long long)got->voxel[pixel],
                 got->distance[pixel], wanted->object[pixel], (unsigned long long)wanted->voxel[pixel],
                 wanted->distance[pixel]);
    }
}

/* Returns how many pixels hit something. */
static size_t compare_with_oracle(struct engine *engine, const conus_atlas *atlas, const struct cone *cone)
{
    struct evidence got, wanted;
    size_t hits = 0;
    assert_ok(evidence_init(&got, cone->resolution));
    assert_ok(evidence_init(&wanted, cone->resolution));
    memset(got.object, 0xff, cone->resolution * cone->resolution * sizeof *got.object);
    assert_ok(engine->functions->look(engine, &got, cone));
    oracle_look(&wanted, atlas, cone);
    for (size_t pixel = 0; pixel < (size_t)cone->resolution * cone->resolution; pixel++) {
        assert_same_pixel(&got, &wanted, pixel);
        hits += wanted.object[pixel] != 0;
    }
    evidence_finish(&got);
    evidence_finish(&wanted);
    return hits;
}

/* Calls body for every kernel that this machine supports. */
static void for_kernels(const conus_atlas *atlas, void (*body)(struct engine *engine, const conus_atlas *atlas, void *),
                        void *data)
{
    const struct engine_options options = {0};
    for (size_t i = 0; traverse_kernel(i); i++) {
        struct engine *engine = NULL;
        if (traverse_kernel(i)->is_supported()) {
            assert_ok(engine_rays_create_with(&engine, atlas, &options, traverse_kernel(i)));
            body(engine, atlas, data);
            engine_destroy(engine);
        }
    }
}

struct poses {
    uint64_t random;
    int count;
    size_t hits;
};

static void look_from_random_poses(struct engine *engine, const conus_atlas *atlas, void *data)
{
    struct poses *poses = data;
    uint64_t random = poses->random;
    for (int pose = 0; pose < poses->count; pose++) {
        struct cone cone = random_cone(&random, atlas);
        poses->hits += compare_with_oracle(engine, atlas, &cone);
    }
}

/* Eq. 5, Eq. 6: object, voxel and distance equal the plain traversal's, to the last bit, for every ray. */
static void every_ray_equals_the_plain_traversal(void **state)
{
    (void)state;
    uint64_t random = 1;
    struct poses poses = {.count = 12};
    for (int scene = 0; scene < 300; scene++) {
        conus_atlas *atlas = scene_atlas(&random, scene % 10 ? 24 : 70, scene % 3);
        poses.random = (uint64_t)scene;
        for_kernels(atlas, look_from_random_poses, &poses);
        conus_atlas_destroy(atlas);
    }
    assert_true(poses.hits > 200000);
}

static conus_status create_and_destroy(void *atlas)
{
    const struct engine_options options = {0};
    struct engine *engine = NULL;
    conus_status status = engine_rays_create(&engine, atlas, &options);
    engine_destroy(engine);
    return status;
}

static void creation_survives_every_failing_allocation(void **state)
{
    (void)state;
    uint64_t random = 2;
    conus_atlas *atlas = scene_atlas(&random, 20, 2);
    test_every_allocation(create_and_destroy, atlas);
    conus_atlas_destroy(atlas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_equals_the_plain_traversal),
        cmocka_unit_test(creation_survives_every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
