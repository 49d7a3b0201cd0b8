/* SPDX-License-Identifier: BSD-3-Clause */
/* First hits of volumes (Eq. 5 to Eq. 7) by the gl engine against those by the rays engine. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/selection.h"
#include "gl_pair.h"
#include "render/gl/gl.h"
#include "scene.h"
#include "test.h"

#include <string.h>

/* Poses are cheap: each scene has a context and programs of its own, which take drivers longer. */
static size_t compare_scenes(uint64_t random, int scenes, conus_sampling sampling)
{
    size_t hits = 0;
    for (int scene = 0; scene < scenes; scene++) {
        conus_atlas *atlas = scene_atlas(&random, scene % 10 ? 24 : 70, scene % 4);
        uint32_t slices = sampling == CONUS_SAMPLING_SLICES ? (uint32_t)test_random(&random, 0, 200) : 0;
        struct gl_pair pair = gl_pair_create_slices(atlas, sampling, slices, scene % 5 / 4.0);
        for (int pose = 0; pose < 24; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            hits += gl_pair_same_hits(&pair, &cone);
        }
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
    return hits;
}

/* Eq. 5, Eq. 6: identical in every pixel, also at cell edges: oblique, flipped, anisotropic and sheared grids, several
 * volumes with contacts at equal distances, apices inside, on cell faces and 1e5 mm away. */
static void exact_equals_rays(void **state)
{
    (void)state;
    assert_true(compare_scenes(11, (int)test_trials(76), CONUS_SAMPLING_EXACT) > test_trials(25000));
}

/* Eq. 7: on the same planes, the same voxels. */
static void slices_equal_the_cpus_slices(void **state)
{
    (void)state;
    assert_true(compare_scenes(12, (int)test_trials(52), CONUS_SAMPLING_SLICES) > test_trials(5000));
}

/* The device keeps shapes and lists of rays from one cone to the next: of all pixels, of some, and of other sizes. */
static void cones_of_many_shapes_take_turns(void **state)
{
    (void)state;
    uint64_t random = 14;
    size_t hits = 0;
    conus_atlas *atlas = scene_atlas(&random, 24, 1);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    for (int turn = 0; turn < 120; turn++) {
        bool wanted[40 * 40];
        struct cone cone = scene_cone(&random, atlas);
        cone.resolution = (const uint32_t[]){16, 16, 40, 17, 16, 5}[turn % 6];
        for (size_t pixel = 0; pixel < sizeof wanted; pixel++) {
            wanted[pixel] = test_random(&random, 0, 1) < 0.5;
        }
        cone.tracing.wanted = turn % 4 == 1 ? wanted : NULL;
        hits += gl_pair_same_hits(&pair, &cone);
    }
    assert_true(hits > 1000);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* Rays of many pixels and volumes do not fit into the ray buffer at once. */
static void big_buffers_take_turns(void **state)
{
    (void)state;
    uint64_t random = 13;
    conus_atlas *atlas = scene_atlas(&random, 30, 3);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    for (int pose = 0; pose < 3; pose++) {
        struct cone cone = {.pose = scene_pose(&random, atlas), .angle = 0.5, .resolution = pose ? 500 : 300};
        gl_pair_same_hits(&pair, &cone);
    }
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

static struct cone cone_from(double x, double y, double z, double degrees, uint32_t resolution)
{
    struct cone cone = {.angle = radians_from_degrees(degrees), .resolution = resolution};
    assert_ok(conus_pose_along(&cone.pose, (double[]){x, y, z}, (double[]){1, 0, 0}, NULL));
    return cone;
}

/* Every voxel is another area, with labels up to 4294967295: objects that fit neither 16 bits nor the integers of a
 * float. */
static void more_objects_than_16_bits_hold(void **state)
{
    (void)state;
    enum { EDGE = 42, COUNT = EDGE * EDGE * EDGE };
    static uint32_t labels[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        labels[i] = UINT32_MAX - 50000 * i % 1000003 - i;
    }
    conus_volume_info info = scene_plain_grid((size_t[]){EDGE, EDGE, EDGE}, NULL);
    conus_atlas *atlas = scene_parcellation(&info, labels);
    assert_non_null(atlas->volumes[0].objects32);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = cone_from(-60, 20.3, 21.1, 40, 64);
    assert_true(gl_pair_same_hits(&pair, &cone) > 64 * 64 / 2);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* Eq. 5, Eq. 11: a wall seen from 1e5 mm away and through its inside, against the closed form. */
static void distances_are_those_of_the_closed_form(void **state)
{
    (void)state;
    static uint32_t labels[8 * 64 * 64];
    for (size_t i = 0; i < sizeof labels / sizeof labels[0]; i++) {
        labels[i] = i % 8 >= 3 ? 9 : 0; /* from x = 2.5 on */
    }
    conus_volume_info info = scene_plain_grid((size_t[]){8, 64, 64}, NULL);
    conus_atlas *atlas = scene_parcellation(&info, labels);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    const struct cone cones[] = {cone_from(-1e5, 31.25, 32.125, 0.03, 16), cone_from(0, 31.25, 32.125, 120, 15),
                                 cone_from(5, 31.25, 32.125, 60, 16)};
    for (int c = 0; c < 3; c++) {
        struct evidence evidence = gl_pair_trace(pair.gl, &cones[c]);
        for (uint32_t p = 0; p < cones[c].resolution * cones[c].resolution; p++) {
            double ray[3];
            cone_ray(ray, &cones[c], p % cones[c].resolution, p / cones[c].resolution);
            double wall = fmax(0, 2.5 - cones[c].pose.world_from_device[12]);
            assert_int_equal(evidence.object[p], 1);
            assert_near(evidence.distance[p], wall / ray[0], 1e-9);
        }
        evidence_finish(&evidence);
    }
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* A context volume is drawn, but never hit. */
static void the_context_is_never_hit(void **state)
{
    (void)state;
    uint32_t labels[27] = {0};
    labels[26] = 1;
    conus_volume_info info = scene_plain_grid((size_t[]){3, 3, 3}, NULL);
    conus_atlas *atlas = scene_parcellation(&info, labels);
    float *values = memory_zeroed(27, sizeof *values);
    assert_non_null(values);
    values[13] = 1000;
    info.role = CONUS_ROLE_CONTEXT;
    assert_ok(atlas_set_context(atlas, &info, values));
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = cone_from(-10, 1, 1, 40, 16);
    assert_true(gl_pair_same_hits(&pair, &cone) > 0);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

static size_t count_blocked(struct engine *engine, const struct cone *cone)
{
    struct evidence evidence = gl_pair_trace(engine, cone);
    size_t blocked = 0;
    for (size_t i = 0; i < (size_t)cone->resolution * cone->resolution; i++) {
        blocked += evidence.object[i] == VOLUME_BLOCKER;
    }
    evidence_finish(&evidence);
    return blocked;
}

static void blocking_contexts_are_seen_alike(void **state)
{
    (void)state;
    uint64_t random = 15;
    size_t blocked = 0;
    size_t hits = 0;
    for (int scene = 0; scene < 20; scene++) {
        conus_sampling sampling = scene % 2 ? CONUS_SAMPLING_SLICES : CONUS_SAMPLING_EXACT;
        conus_atlas *atlas = scene_atlas(&random, 24, scene % 3);
        scene_add_blockers(atlas, &random, (size_t[]){9, 7, 8}, 0.1);
        struct gl_pair pair = gl_pair_create(atlas, sampling);
        for (int pose = 0; pose < 6; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            hits += gl_pair_same_hits(&pair, &cone);
            blocked += count_blocked(pair.rays, &cone);
        }
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
    assert_true(blocked > 500 && hits - blocked > 500);
}

static GLint longest_texture(void)
{
    struct gl_context *context = NULL;
    struct gl_current previous;
    GLint limit = 0;
    assert_ok(gl_context_create(&context, NULL, NULL));
    assert_ok(gl_context_use(context, &previous));
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
    gl_current_restore(&previous);
    gl_context_destroy(context);
    return limit;
}

static void a_volume_too_long_for_the_driver_is_refused(void **state)
{
    (void)state;
    conus_volume_info small = scene_plain_grid((size_t[]){1, 1, 1}, NULL);
    conus_atlas *atlas = scene_parcellation(&small, (uint32_t[]){1});
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT); /* or skips */
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
    size_t length = (size_t)longest_texture() + 1;
    conus_volume_info info = scene_plain_grid((size_t[]){1, length, 1}, NULL);
    uint32_t *labels = memory_zeroed(length, sizeof *labels);
    assert_non_null(labels);
    labels[0] = 1;
    atlas = scene_parcellation(&info, labels);
    const struct engine_options options = {0};
    struct engine *engine = NULL;
    assert_fails(engine_gl_create(&engine, atlas, &options), CONUS_ERROR_GL);
    assert_null(engine);
    assert_non_null(strstr(conus_message(), "along an edge"));
    memory_free(labels);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    uint64_t random = 14;
    conus_atlas *atlas = scene_atlas(&random, 20, 2);
    struct cone cone = cone_from(-10, 0, 0, 20, 4);
    gl_pair_every_allocation(atlas, &cone, false);
    conus_atlas_destroy(atlas);
}

/* An application's own context is current again after each call. */
static void the_callers_context_stays_current(void **state)
{
    (void)state;
    uint64_t random = 15;
    conus_atlas *atlas = scene_atlas(&random, 20, 1);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct gl_context *own = NULL;
    struct gl_current previous;
    assert_ok(gl_context_create(&own, NULL, NULL));
    assert_ok(gl_context_use(own, &previous));
    EGLContext is = eglGetCurrentContext();
    struct cone cone = scene_cone(&random, atlas);
    gl_pair_same_hits(&pair, &cone);
    assert_ptr_equal(eglGetCurrentContext(), is);
    struct gl_pair another = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    gl_pair_destroy(&another);
    assert_ptr_equal(eglGetCurrentContext(), is);
    gl_pair_destroy(&pair);
    assert_ptr_equal(eglGetCurrentContext(), is);
    gl_current_restore(&previous);
    gl_context_destroy(own);
    conus_atlas_destroy(atlas);
}

static void compare_on(const char *name, uint64_t random, int poses)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron(name), NULL));
    struct gl_pair exact = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct gl_pair slices = gl_pair_create(atlas, CONUS_SAMPLING_SLICES);
    size_t hits = 0;
    for (int pose = 0; pose < poses; pose++) {
        struct cone cone = scene_cone(&random, atlas);
        hits += gl_pair_same_hits(&exact, &cone);
        gl_pair_same_hits(&slices, &cone);
    }
    assert_true(hits > 1000);
    gl_pair_destroy(&exact);
    gl_pair_destroy(&slices);
    conus_atlas_destroy(atlas);
}

static void real_atlases_are_seen_alike(void **state)
{
    (void)state;
    static const char *const names[] = {"aal.nii.gz",
                                        "brodmann.nii.gz",
                                        "AICHAmc.nii.gz",
                                        "HarvardOxford-cort-maxprob-thr0-1mm.nii.gz",
                                        "JHU-WhiteMatter-labels-1mm.nii.gz",
                                        "JHU-WhiteMatter-labels-2mm.nii.gz",
                                        "jhu189.nii.gz",
                                        "natbrainlab.nii.gz",
                                        "inia19-NeuroMaps.nii.gz"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        compare_on(names[i], 20 + i, 50);
    }
}

TEST_GROUP(gl_id)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_equals_rays),
        cmocka_unit_test(slices_equal_the_cpus_slices),
        cmocka_unit_test(cones_of_many_shapes_take_turns),
        cmocka_unit_test(big_buffers_take_turns),
        cmocka_unit_test(more_objects_than_16_bits_hold),
        cmocka_unit_test(distances_are_those_of_the_closed_form),
        cmocka_unit_test(the_context_is_never_hit),
        cmocka_unit_test(blocking_contexts_are_seen_alike),
        cmocka_unit_test(a_volume_too_long_for_the_driver_is_refused),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(the_callers_context_stays_current),
        cmocka_unit_test(real_atlases_are_seen_alike),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
