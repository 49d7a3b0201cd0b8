/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels against the plain traversal, on a real atlas. */
#include "base/geometry/math3.h"
#include "oracle_traversal.h"
#include "selection/engine/engine.h"
#include "selection/engine/voxels/traverse.h"
#include "test.h"

enum { POSES = 250 };

/* A cone from inside the head or up to 250 mm away, aimed near its middle; 1 to 90 degrees; 1 to 40 pixels. */
static struct cone random_cone(uint64_t *random, const conus_atlas *atlas)
{
    const conus_volume_info *info = &atlas->volumes[0].info;
    double target[3], direction[3], origin[3];
    for (int a = 0; a < 3; a++) {
        target[a] = (double)info->dim[a] * test_random(random, 0.25, 0.75);
        direction[a] = test_random(random, -1, 1);
    }
    mat4_point(target, info->world_from_voxel, target);
    vec3_add_scaled(origin, target, -test_random(random, 0, 250) / vec3_length(direction), direction);
    struct cone cone = {.angle = radians_from_degrees(test_random(random, 1, test_random(random, 2, 90)))};
    cone.resolution = (uint32_t)test_random(random, 1, 41);
    assert_ok(conus_pose_along(&cone.pose, origin, direction, NULL));
    return cone;
}

static size_t compare(struct engine *engine, const conus_atlas *atlas, const struct cone *cone)
{
    size_t pixels = (size_t)cone->resolution * cone->resolution;
    size_t hits = 0;
    struct evidence got, wanted;
    assert_ok(evidence_init(&got, cone->resolution));
    assert_ok(evidence_init(&wanted, cone->resolution));
    assert_ok(engine->functions->trace(engine, &got, cone));
    oracle_trace(&wanted, atlas, cone);
    assert_memory_equal(got.object, wanted.object, pixels * sizeof *got.object);
    assert_memory_equal(got.voxel, wanted.voxel, pixels * sizeof *got.voxel);
    assert_memory_equal(got.distance, wanted.distance, pixels * sizeof *got.distance);
    for (size_t i = 0; i < pixels; i++) {
        hits += got.object[i] != 0;
    }
    evidence_finish(&got);
    evidence_finish(&wanted);
    return hits;
}

/* Eq. 5 on a real atlas, the file that *state names: every kernel, every ray, every bit. */
static void kernels_equal_the_plain_traversal(void **state)
{
    conus_atlas *atlas = NULL;
    const struct engine_options options = {0};
    assert_ok(conus_atlas_load(&atlas, test_mricron(*state), NULL));
    for (size_t k = 0; traverse_kernel(k); k++) {
        uint64_t random = 11;
        size_t hits = 0;
        struct engine *engine = NULL;
        if (!traverse_kernel(k)->is_supported()) {
            continue;
        }
        assert_ok(engine_rays_create_with(&engine, atlas, &options, traverse_kernel(k)));
        for (int pose = 0; pose < POSES; pose++) {
            struct cone cone = random_cone(&random, atlas);
            hits += compare(engine, atlas, &cone);
        }
        assert_true(hits > 1000);
        engine_destroy(engine);
    }
    conus_atlas_destroy(atlas);
}

#define ATLAS(file) cmocka_unit_test_prestate(kernels_equal_the_plain_traversal, file)

TEST_GROUP(rays_data)
{
    const struct CMUnitTest tests[] = {
        ATLAS("aal.nii.gz"),
        ATLAS("AICHAmc.nii.gz"),
        ATLAS("brodmann.nii.gz"),
        ATLAS("HarvardOxford-cort-maxprob-thr0-1mm.nii.gz"),
        ATLAS("inia19-NeuroMaps.nii.gz"),
        ATLAS("jhu189.nii.gz"),
        ATLAS("JHU-WhiteMatter-labels-1mm.nii.gz"),
        ATLAS("JHU-WhiteMatter-labels-2mm.nii.gz"),
        ATLAS("natbrainlab.nii.gz"),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
