/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/math3.h"
#include "base/memory.h"
#include "oracle_traversal.h"
#include "scene.h"
#include "selection/evidence.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static void print_line(void *user, const char *line)
{
    (void)user;
    print_message("%s\n", line);
}

/* The gl engine for `atlas`, or the running test is skipped, saying why. */
static struct engine *gl_engine(const conus_atlas *atlas, conus_sampling sampling)
{
    const struct engine_options options = {.sampling = sampling, .log = print_line};
    struct engine *engine = NULL;
    conus_status status = engine_gl_create(&engine, atlas, &options);
    if (status == CONUS_ERROR_GL) {
        print_message("skipped: %s\n", conus_message());
        skip();
    }
    assert_ok(status);
    return engine;
}

static struct cone random_cone(uint64_t *state, const conus_atlas *atlas)
{
    struct cone cone = {.pose = scene_pose(state, atlas)};
    cone.angle =
        radians_from_degrees(test_random(state, 0, 1) < 0.5 ? test_random(state, 1, 20) : test_random(state, 1, 170));
    cone.resolution = 1 + (uint32_t)test_random(state, 0, test_random(state, 0, 1) < 0.2 ? 64 : 17);
    return cone;
}

static size_t count_different(const struct evidence *got, const struct evidence *wanted, const char *scene)
{
    size_t different = 0;
    for (size_t i = 0; i < (size_t)got->resolution * got->resolution; i++) {
        bool same = got->object[i] == wanted->object[i] && got->voxel[i] == wanted->voxel[i] &&
                    got->distance[i] == wanted->distance[i];
        if (!same && ++different <= 3) {
            print_message("%s, pixel %zu of %u x %u: object %u, voxel %llu, %.17g mm; wanted %u, %llu, %.17g\n", scene,
                          i, got->resolution, got->resolution, got->object[i], (unsigned long long)got->voxel[i],
                          got->distance[i], wanted->object[i], (unsigned long long)wanted->voxel[i],
                          wanted->distance[i]);
        }
    }
    return different;
}

/* Pixels in which two engines differ in object, voxel or (by a single bit) distance; *hits grows by those hit. */
static size_t compare(struct engine *engine, struct engine *other, const struct cone *cone, const char *scene,
                      size_t *hits)
{
    struct evidence got, wanted;
    size_t pixels = (size_t)cone->resolution * cone->resolution;
    assert_ok(evidence_init(&got, cone->resolution));
    assert_ok(evidence_init(&wanted, cone->resolution));
    memset(got.object, 0xff, pixels * sizeof *got.object);
    assert_ok(engine->functions->look(engine, &got, cone));
    assert_ok(other->functions->look(other, &wanted, cone));
    size_t different = count_different(&got, &wanted, scene);
    for (size_t i = 0; i < pixels; i++) {
        *hits += wanted.object[i] != 0;
    }
    evidence_finish(&got);
    evidence_finish(&wanted);
    return different;
}

static struct engine *rays_engine(const conus_atlas *atlas, conus_sampling sampling)
{
    const struct engine_options options = {.sampling = sampling};
    struct engine *engine = NULL;
    assert_ok(engine_rays_create(&engine, atlas, &options));
    return engine;
}

/* Eq. 5, Eq. 6: object, voxel and distance equal the ray engine's to the last bit, in every pixel: oblique, flipped,
 * anisotropic and sheared grids, several volumes, apices inside, on cell faces and 1e5 mm away. */
static void exact_equals_rays(void **state)
{
    (void)state;
    uint64_t random = 11;
    size_t hits = 0;
    size_t different = 0;
    for (int scene = 0; scene < 150; scene++) {
        conus_atlas *atlas = scene_atlas(&random, scene % 10 ? 24 : 70, scene % 4);
        struct engine *gl = gl_engine(atlas, CONUS_EXACT);
        struct engine *rays = rays_engine(atlas, CONUS_EXACT);
        for (int pose = 0; pose < 12; pose++) {
            struct cone cone = random_cone(&random, atlas);
            different += compare(gl, rays, &cone, "random scene", &hits);
        }
        engine_destroy(rays);
        engine_destroy(gl);
        conus_atlas_destroy(atlas);
    }
    assert_true(hits > 25000);
    assert_int_equal(different, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_equals_rays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
