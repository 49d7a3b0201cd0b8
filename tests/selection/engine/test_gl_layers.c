/* SPDX-License-Identifier: BSD-3-Clause */
/* All layers (Eq. 10) of volumes in the gl engine against those in the rays engine. */
#include "base/geometry/math3.h"
#include "conus/selection.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "same_answer.h"
#include "scene.h"
#include "test.h"

static void fail_at_interval(const struct cone *cone, const conus_interval *got, const conus_interval *wanted)
{
    fail_msg("%u x %u, %g degrees: pixel %u object %u from %.17g to %.17g voxel %llu; wanted %u %u %.17g %.17g %llu",
             cone->resolution, cone->resolution, degrees_from_radians(cone->angle), got->pixel, got->object, got->entry,
             got->exit, (unsigned long long)got->voxel, wanted->pixel, wanted->object, wanted->entry, wanted->exit,
             (unsigned long long)wanted->voxel);
}

/* Fails where the intervals differ by a single bit. */
static void assert_same_intervals(struct gl_pair *pair, const struct cone *cone)
{
    struct layers got = gl_pair_pierce(pair->gl, cone);
    struct layers wanted = gl_pair_pierce(pair->rays, cone);
    for (size_t i = 0; i < got.count && i < wanted.count; i++) {
        if (!gl_pair_same_interval(&got.intervals[i], &wanted.intervals[i])) {
            fail_at_interval(cone, &got.intervals[i], &wanted.intervals[i]);
        }
        pair->counts.blocked += wanted.intervals[i].object == VOLUME_BLOCKER;
    }
    assert_int_equal(got.count, wanted.count);
    pair->counts.hits += wanted.count;
    layers_finish(&got);
    layers_finish(&wanted);
}

static conus_atlas *grid_atlas(size_t edge, const uint32_t *labels)
{
    const conus_volume_info grid = scene_plain_grid((size_t[]){edge, edge, edge}, NULL);
    return scene_parcellation(&grid, labels);
}

static void make_cylinder(struct cone *cone, double radius)
{
    cone->angle = 0;
    cone->radius = radius;
}

static size_t compare_scenes(uint64_t random, int scenes, bool cylinders)
{
    size_t intervals = 0;
    for (int scene = 0; scene < scenes; scene++) {
        conus_atlas *atlas = scene_atlas(&random, scene % 10 ? 24 : 70, scene % 4);
        struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
        for (int pose = 0; pose < 16; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            if (cylinders) {
                make_cylinder(&cone, test_random(&random, 0.01, 30));
            }
            assert_same_intervals(&pair, &cone);
        }
        intervals += pair.counts.hits;
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
    return intervals;
}

/* Eq. 10: oblique, flipped, anisotropic and sheared grids, several volumes, apices inside, on faces and far away. */
static void intervals_of_volumes_are_those_of_rays(void **state)
{
    (void)state;
    assert_true(compare_scenes(71, 52, false) > 200000);
}

static void intervals_in_cylinders_are_those_of_rays(void **state)
{
    (void)state;
    assert_true(compare_scenes(72, 20, true) > 50000);
}

/* Eq. 3, Eq. 5, Eq. 7: first hits in cylinders. */
static void traces_in_cylinders_are_those_of_rays(void **state)
{
    (void)state;
    uint64_t random = 73;
    size_t hits = 0;
    for (int scene = 0; scene < 40; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 24, scene % 3);
        struct gl_pair pair = gl_pair_create(atlas, scene % 2 ? CONUS_SAMPLING_SLICES : CONUS_SAMPLING_EXACT);
        for (int pose = 0; pose < 8; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            make_cylinder(&cone, test_random(&random, 0.01, 30));
            hits += gl_pair_same_hits(&pair, &cone);
        }
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
    assert_true(hits > 5000);
}

static void what_blocks_has_intervals_too(void **state)
{
    (void)state;
    uint64_t random = 74;
    size_t blocked = 0;
    for (int scene = 0; scene < 10; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 24, scene % 3);
        scene_add_blockers(atlas, &random, (size_t[]){9, 7, 8}, 0.1);
        struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
        for (int pose = 0; pose < 8; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            assert_same_intervals(&pair, &cone);
        }
        blocked += pair.counts.blocked;
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
    assert_true(blocked > 500);
}

/* More intervals than a list on the device holds: the pixels are drawn in portions. */
static void a_million_intervals_come_in_portions(void **state)
{
    (void)state;
    enum { EDGE = 40, COUNT = EDGE * EDGE * EDGE };
    static uint32_t labels[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        labels[i] = 1 + i; /* every cell is an interval */
    }
    conus_atlas *atlas = grid_atlas(EDGE, labels);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct cone cone = {.angle = radians_from_degrees(30), .resolution = 160};
    assert_ok(conus_pose_toward(&cone.pose, (double[]){-60, 17, 25}, (double[]){19, 20, 21}, NULL));
    assert_same_intervals(&pair, &cone);
    assert_true(pair.counts.hits > ((size_t)1 << 24) / sizeof(conus_interval));
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* A million voxels in millimetres, cones and cylinders of any size. */
static void intervals_of_a_real_atlas_are_those_of_rays(void **state)
{
    (void)state;
    uint64_t random = 75;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    for (int pose = 0; pose < 100; pose++) {
        struct cone cone = {.pose = scene_pose(&random, atlas), .resolution = pose % 10 ? 16 : 64};
        cone.angle = radians_from_degrees(test_random(&random, 1, 40));
        if (pose % 4 == 3) {
            make_cylinder(&cone, test_random(&random, 0.5, 30));
        }
        assert_same_intervals(&pair, &cone);
    }
    assert_true(pair.counts.hits > 50000);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

/* Compares bit for bit, which tells -0 from 0. Both have as many results. */
static void assert_same_bits(const conus_selection *got, const conus_selection *wanted)
{
    size_t count = 0, wanted_count = 0;
    const conus_interval *intervals = conus_selection_intervals(&count, got);
    const conus_interval *wanted_intervals = conus_selection_intervals(&wanted_count, wanted);
    assert_int_equal(count, wanted_count);
    assert_memory_equal(intervals, wanted_intervals, count * sizeof *intervals);
    for (size_t i = 0; i < conus_selection_count(got); i++) {
        const conus_result *a = conus_selection_result(got, i);
        const conus_result *b = conus_selection_result(wanted, i);
        assert_memory_equal(&a->path, &b->path, sizeof a->path);
        assert_memory_equal(a->contact, b->contact, sizeof a->contact);
    }
}

/* With a range first hits, too, come from the intervals. */
static void answers_with_a_range_are_those_of_rays(void **state)
{
    (void)state;
    uint64_t random = 76;
    for (int scene = 0; scene < 30; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 24, scene % 3);
        struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT); /* or skips */
        gl_pair_destroy(&pair);
        struct cone cone = scene_cone(&random, atlas);
        conus_selector_options options = {.layers = scene % 3 ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE,
                                          .range = {test_random(&random, 0, 20), test_random(&random, 20, 200)},
                                          .resolution = cone.resolution};
        if (scene % 2) {
            make_cylinder(&cone, test_random(&random, 0.5, 30));
            options.radius = cone.radius;
        }
        conus_selection *wanted = mesh_scene_select(atlas, &options, &cone);
        options.engine = CONUS_ENGINE_GL;
        conus_selection *got = mesh_scene_select(atlas, &options, &cone);
        assert_same_answer(got, wanted, 0);
        assert_same_bits(got, wanted);
        conus_selection_destroy(got);
        conus_selection_destroy(wanted);
        conus_atlas_destroy(atlas);
    }
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    uint32_t labels[6 * 6 * 6];
    for (uint32_t i = 0; i < 6 * 6 * 6; i++) {
        labels[i] = 1 + i; /* more intervals than fit at first */
    }
    conus_atlas *atlas = grid_atlas(6, labels);
    struct cone cone = {.angle = radians_from_degrees(60), .resolution = 60};
    assert_ok(conus_pose_toward(&cone.pose, (double[]){-20, 3, 4}, (double[]){2, 3, 4}, NULL));
    gl_pair_every_allocation(atlas, &cone, true);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(gl_layers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_of_volumes_are_those_of_rays),
        cmocka_unit_test(intervals_in_cylinders_are_those_of_rays),
        cmocka_unit_test(traces_in_cylinders_are_those_of_rays),
        cmocka_unit_test(what_blocks_has_intervals_too),
        cmocka_unit_test(a_million_intervals_come_in_portions),
        cmocka_unit_test(intervals_of_a_real_atlas_are_those_of_rays),
        cmocka_unit_test(answers_with_a_range_are_those_of_rays),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
