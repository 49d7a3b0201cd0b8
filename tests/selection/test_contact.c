/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 11: the contact is at the pixel with the smallest r; of several with the same r it is the nearest. r is the same
 * for pixels with the same (2i + 1 - n)^2 + (2j + 1 - n)^2, by which the wanted pixel is found here. */
#include "base/geometry/math3.h"
#include "conus/arrays.h"
#include "scene.h"
#include "selection/measure/measure.h"
#include "test.h"
#include "test_gl.h"

#include <string.h>

enum { OBJECTS = 3, LARGEST = 64 };

/* The pixel of the cone that hits `object` at the smallest square, then at the smallest distance; UINT32_MAX where none
 * does. */
static uint32_t wanted_pixel(int64_t *square, const struct evidence *evidence, uint32_t object)
{
    int64_t n = evidence->resolution;
    uint32_t best = UINT32_MAX;
    for (int64_t pixel = 0; pixel < n * n; pixel++) {
        int64_t u = 2 * (pixel % n) + 1 - n;
        int64_t v = 2 * (pixel / n) + 1 - n;
        int64_t s = u * u + v * v;
        bool better =
            best == UINT32_MAX || s < *square || (s == *square && evidence->distance[pixel] < evidence->distance[best]);
        if (s <= n * n && evidence->object[pixel] == object && better) {
            best = (uint32_t)pixel;
            *square = s;
        }
    }
    return best;
}

static void check_contacts(const struct statistics *statistics, const struct evidence *evidence,
                           const struct cone *cone)
{
    for (size_t k = 0; k < statistics->count; k++) {
        const conus_result *result = &statistics->results[k];
        int64_t square = 0;
        uint32_t pixel = wanted_pixel(&square, evidence, result->object);
        double wanted[3];
        if (result->object) {
            assert_true(pixel != UINT32_MAX);
            evidence_position(wanted, evidence, cone, pixel % cone->resolution, pixel / cone->resolution);
            assert_memory_equal(result->contact, wanted, sizeof wanted);
            assert_near(result->centre_px, sqrt((double)square) / 2, 0);
        }
    }
}

/* Evidence of every resolution up to 64 with random objects and distances, so that many pixels tie in r. */
static void the_pixel_with_the_smallest_r_is_found(void **state)
{
    (void)state;
    const uint32_t labels[OBJECTS] = {1, 2, 3};
    const conus_volume_info grid = scene_plain_grid((size_t[]){OBJECTS, 1, 1}, NULL);
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    struct aperture aperture = {0};
    struct tally tally = {0};
    uint64_t random = 11;
    assert_ok(tally_prepare(&tally, OBJECTS));
    for (uint32_t n = 1; n <= LARGEST; n++) {
        struct cone cone = {.angle = 0.5, .resolution = n};
        struct evidence evidence;
        struct statistics statistics = {0};
        mat4_identity(cone.pose.world_from_device);
        assert_ok(evidence_init(&evidence, n));
        for (size_t pixel = 0; pixel < (size_t)n * n; pixel++) {
            evidence.object[pixel] = (uint32_t)test_random(&random, 0, OBJECTS + 1);
            evidence.distance[pixel] = test_random(&random, 10, 100);
        }
        assert_ok(aperture_prepare(&aperture, &cone));
        const struct gathering gathering = {
            .atlas = atlas, .cone = &cone, .aperture = &aperture, .evidence = &evidence};
        assert_ok(statistics_gather(&statistics, &gathering, &tally));
        check_contacts(&statistics, &evidence, &cone);
        statistics_finish(&statistics);
        evidence_finish(&evidence);
    }
    tally_finish(&tally);
    aperture_finish(&aperture);
    conus_atlas_destroy(atlas);
}

/* A cone along the edge of a step: the object begins at the depth of 60 mm on one side of the axis, at 93 mm on the
 * other. An even n has four innermost pixels, two on either side: the contact is at 60 mm. */
enum { NEAR = 60, RISE = 33 };

static conus_atlas *make_step(int axis, int near_side)
{
    size_t dim[3] = {1, 1, RISE + 1};
    double world[16] = {[2] = 0, [10] = -1, [14] = -NEAR - 0.5, [15] = 1};
    uint32_t labels[2 * (RISE + 1)] = {0};
    conus_atlas *atlas = NULL;
    dim[axis] = 2;
    world[0] = world[5] = 400;
    world[12 + axis] = -200;
    labels[near_side] = 1;
    labels[2 * RISE + !near_side] = 1;
    conus_voxels voxels = {.data = labels, .type = CONUS_SCALAR_UINT32, .dim = {dim[0], dim[1], dim[2]}};
    memcpy(voxels.world_from_voxel, world, sizeof world);
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL));
    return atlas;
}

static void check_step(conus_engine engine)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 0}, (double[]){0, 0, -1}, NULL));
    for (int side = 0; side < 4; side++) {
        conus_atlas *atlas = make_step(side / 2, side % 2);
        for (uint32_t n = 2; n <= LARGEST; n += 2) {
            const conus_selector_options options = {.engine = engine, .resolution = n};
            conus_selector *selector = NULL;
            conus_selection *selection = NULL;
            assert_gl(conus_selector_create(&selector, atlas, &options));
            assert_ok(conus_select(&selection, selector, &pose, 20));
            assert_near(conus_selection_result(selection, 0)->contact[2], -NEAR, 1e-9);
            conus_selection_destroy(selection);
            conus_selector_destroy(selector);
        }
        conus_atlas_destroy(atlas);
    }
}

static void a_step_is_met_on_its_near_side(void **state)
{
    (void)state;
    check_step(CONUS_ENGINE_RAYS);
}

static void the_gl_engine_meets_it_there_too(void **state)
{
    (void)state;
    check_step(CONUS_ENGINE_GL);
}

TEST_GROUP(contact)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_pixel_with_the_smallest_r_is_found),
        cmocka_unit_test(a_step_is_met_on_its_near_side),
        cmocka_unit_test(the_gl_engine_meets_it_there_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
