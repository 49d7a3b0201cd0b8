/* SPDX-License-Identifier: BSD-3-Clause */
/* All layers (Eq. 10) of volumes in the gl engine against those in the rays engine. */
#include "atlas/space.h"
#include "base/math3.h"
#include "base/memory.h"
#include "gl_pair.h"
#include "scene.h"
#include "test.h"

#include <string.h>

/* The engines, and what has been compared. */
struct pair {
    struct gl_pair engines;
    size_t spans, blocked;
};

static struct pair pair_of(const conus_atlas *atlas)
{
    return (struct pair){.engines = gl_pair_create(atlas, CONUS_EXACT)};
}

static void pair_finish(struct pair *pair)
{
    gl_pair_destroy(&pair->engines);
}

static void fail_at(const struct cone *cone, const conus_span *got, const conus_span *wanted)
{
    fail_msg("%u x %u, %g degrees: pixel %u object %u from %.17g to %.17g voxel %llu; wanted %u %u %.17g %.17g %llu",
             cone->resolution, cone->resolution, degrees_from_radians(cone->angle), got->pixel, got->object, got->entry,
             got->exit, (unsigned long long)got->voxel, wanted->pixel, wanted->object, wanted->entry, wanted->exit,
             (unsigned long long)wanted->voxel);
}

/* Fails where the pieces differ by a single bit. */
static void assert_same_pieces(struct pair *pair, const struct cone *cone)
{
    struct layers got = gl_pair_pierce(pair->engines.gl, cone);
    struct layers wanted = gl_pair_pierce(pair->engines.rays, cone);
    for (size_t i = 0; i < got.count && i < wanted.count; i++) {
        if (!gl_pair_same_piece(&got.spans[i], &wanted.spans[i])) {
            fail_at(cone, &got.spans[i], &wanted.spans[i]);
        }
        pair->blocked += wanted.spans[i].object == VOLUME_BLOCKER;
    }
    assert_int_equal(got.count, wanted.count);
    pair->spans += wanted.count;
    layers_finish(&got);
    layers_finish(&wanted);
}

/* Fails where the looks differ by a single bit. Returns how many pixels hit. */
static size_t assert_same_look(struct gl_pair *pair, const struct cone *cone)
{
    struct evidence got, wanted;
    size_t pixels = (size_t)cone->resolution * cone->resolution;
    size_t hits = 0;
    assert_ok(evidence_init(&got, cone->resolution));
    assert_ok(evidence_init(&wanted, cone->resolution));
    assert_ok(pair->gl->functions->trace(pair->gl, &got, cone));
    assert_ok(pair->rays->functions->trace(pair->rays, &wanted, cone));
    assert_memory_equal(got.object, wanted.object, pixels * sizeof *got.object);
    assert_memory_equal(got.distance, wanted.distance, pixels * sizeof *got.distance);
    assert_memory_equal(got.voxel, wanted.voxel, pixels * sizeof *got.voxel);
    for (size_t i = 0; i < pixels; i++) {
        hits += wanted.object[i] != 0;
    }
    evidence_finish(&got);
    evidence_finish(&wanted);
    return hits;
}

static conus_atlas *grid_atlas(size_t edge, const uint32_t *labels)
{
    conus_volume_info info = {.role = CONUS_PARCELLATION, .path = "grid", .dim = {edge, edge, edge}, .slope = 1};
    struct label_table table = {0};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    double world_from_voxel[16];
    mat4_identity(world_from_voxel);
    assert_ok(space_describe(&info, world_from_voxel, "a test"));
    assert_ok(atlas_create(&atlas, &info, labels, &table, "a test", &notes));
    notes_finish(&notes);
    return atlas;
}

static void make_cylinder(struct cone *cone, double radius)
{
    cone->angle = 0;
    cone->radius = radius;
}

static size_t compare_scenes(uint64_t random, int scenes, bool cylinders)
{
    size_t spans = 0;
    for (int scene = 0; scene < scenes; scene++) {
        conus_atlas *atlas = scene_atlas(&random, scene % 10 ? 24 : 70, scene % 4);
        struct pair pair = pair_of(atlas);
        for (int pose = 0; pose < 8; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            if (cylinders) {
                make_cylinder(&cone, test_random(&random, 0.01, 30));
            }
            assert_same_pieces(&pair, &cone);
        }
        spans += pair.spans;
        pair_finish(&pair);
        conus_atlas_destroy(atlas);
    }
    return spans;
}

/* Eq. 10: oblique, flipped, anisotropic and sheared grids, several volumes, apices inside, on faces and far away. */
static void pieces_of_volumes_are_those_of_rays(void **state)
{
    (void)state;
    assert_true(compare_scenes(71, 100, false) > 200000);
}

static void pieces_in_cylinders_are_those_of_rays(void **state)
{
    (void)state;
    assert_true(compare_scenes(72, 40, true) > 50000);
}

/* Eq. 3, Eq. 5, Eq. 7: the visible part of cylinders. */
static void looks_through_cylinders_are_those_of_rays(void **state)
{
    (void)state;
    uint64_t random = 73;
    size_t hits = 0;
    for (int scene = 0; scene < 40; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 24, scene % 3);
        struct gl_pair pair = gl_pair_create(atlas, scene % 2 ? CONUS_SLICES : CONUS_EXACT);
        for (int pose = 0; pose < 8; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            make_cylinder(&cone, test_random(&random, 0.01, 30));
            hits += assert_same_look(&pair, &cone);
        }
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
    assert_true(hits > 5000);
}

/* Grids of their own, voxels that block strewn over them. */
static void add_blocking_context(conus_atlas *atlas, uint64_t *random)
{
    const size_t dim[3] = {9, 7, 8};
    conus_volume_info info = scene_grid(random, dim);
    float *values = memory_zeroed(9 * 7 * 8, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < 9 * 7 * 8; v++) {
        values[v] = (float)test_random(random, 0, 1);
    }
    info.role = CONUS_CONTEXT;
    info.threshold = 0.9;
    assert_ok(atlas_set_context(atlas, &info, values));
}

static void what_blocks_has_pieces_too(void **state)
{
    (void)state;
    uint64_t random = 74;
    size_t blocked = 0;
    for (int scene = 0; scene < 10; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 24, scene % 3);
        add_blocking_context(atlas, &random);
        struct pair pair = pair_of(atlas);
        for (int pose = 0; pose < 8; pose++) {
            struct cone cone = scene_cone(&random, atlas);
            assert_same_pieces(&pair, &cone);
        }
        blocked += pair.blocked;
        pair_finish(&pair);
        conus_atlas_destroy(atlas);
    }
    assert_true(blocked > 500);
}

/* More pieces than a list on the device holds: the pixels are drawn in portions. */
static void a_million_pieces_come_in_portions(void **state)
{
    (void)state;
    enum { EDGE = 40, COUNT = EDGE * EDGE * EDGE };
    static uint32_t labels[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        labels[i] = 1 + i; /* every cell is a piece */
    }
    conus_atlas *atlas = grid_atlas(EDGE, labels);
    struct pair pair = pair_of(atlas);
    struct cone cone = {.angle = radians_from_degrees(30), .resolution = 160};
    assert_ok(conus_pose_toward(&cone.pose, (double[]){-60, 17, 25}, (double[]){19, 20, 21}, NULL));
    assert_same_pieces(&pair, &cone);
    assert_true(pair.spans > ((size_t)1 << 24) / sizeof(conus_span));
    pair_finish(&pair);
    conus_atlas_destroy(atlas);
}

/* A million voxels in millimetres, cones and needles of any size. */
static void pieces_of_a_real_atlas_are_those_of_rays(void **state)
{
    (void)state;
    uint64_t random = 75;
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    struct pair pair = pair_of(atlas);
    for (int pose = 0; pose < 100; pose++) {
        struct cone cone = {.pose = scene_pose(&random, atlas), .resolution = pose % 10 ? 16 : 64};
        cone.angle = radians_from_degrees(test_random(&random, 1, 40));
        if (pose % 4 == 3) {
            make_cylinder(&cone, test_random(&random, 0.5, 30));
        }
        assert_same_pieces(&pair, &cone);
    }
    assert_true(pair.spans > 50000);
    pair_finish(&pair);
    conus_atlas_destroy(atlas);
}

static conus_selection *select_with(const conus_atlas *atlas, const conus_selector_options *options,
                                    const struct cone *cone)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_select(&selection, selector, &cone->pose, cone->angle));
    conus_selector_destroy(selector);
    return selection;
}

static void assert_same_results(const conus_selection *got, const conus_selection *wanted)
{
    size_t count = 0, wanted_count = 0;
    const conus_span *spans = conus_selection_spans(got, &count);
    const conus_span *wanted_spans = conus_selection_spans(wanted, &wanted_count);
    assert_int_equal(count, wanted_count);
    assert_memory_equal(spans, wanted_spans, count * sizeof *spans);
    assert_int_equal(conus_selection_count(got), conus_selection_count(wanted));
    for (size_t i = 0; i < conus_selection_count(got); i++) {
        const conus_result *a = conus_selection_result(got, i);
        const conus_result *b = conus_selection_result(wanted, i);
        assert_int_equal(a->object, b->object);
        assert_int_equal(a->pixels, b->pixels);
        assert_int_equal(a->pierced, b->pierced);
        assert_int_equal(a->voxels, b->voxels);
        assert_memory_equal(&a->path, &b->path, sizeof a->path);
        assert_memory_equal(&a->contact, &b->contact, sizeof a->contact);
    }
}

/* With a range the visible part, too, comes from the pieces. */
static void answers_with_a_range_are_those_of_rays(void **state)
{
    (void)state;
    uint64_t random = 76;
    for (int scene = 0; scene < 30; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 24, scene % 3);
        pair_finish(&(struct pair){.engines = gl_pair_create(atlas, CONUS_EXACT)}); /* or skips */
        struct cone cone = scene_cone(&random, atlas);
        conus_selector_options options = {.layers = scene % 3 ? CONUS_ALL_LAYERS : CONUS_VISIBLE,
                                          .range = {test_random(&random, 0, 20), test_random(&random, 20, 200)},
                                          .resolution = cone.resolution};
        if (scene % 2) {
            make_cylinder(&cone, test_random(&random, 0.5, 30));
            options.radius = cone.radius;
        }
        conus_selection *wanted = select_with(atlas, &options, &cone);
        options.engine = CONUS_ENGINE_GL;
        conus_selection *got = select_with(atlas, &options, &cone);
        assert_same_results(got, wanted);
        conus_selection_destroy(got);
        conus_selection_destroy(wanted);
        conus_atlas_destroy(atlas);
    }
}

static conus_status create_pierce_destroy(void *atlas)
{
    const struct engine_options options = {0};
    struct engine *engine = NULL;
    struct layers layers = {0};
    struct cone cone = {.angle = radians_from_degrees(60), .resolution = 60};
    conus_status status = conus_pose_toward(&cone.pose, (double[]){-20, 3, 4}, (double[]){2, 3, 4}, NULL);
    status = status ? status : engine_gl_create(&engine, atlas, &options);
    status = status ? status : engine->functions->pierce(engine, &layers, &cone);
    engine_destroy(engine);
    layers_finish(&layers);
    return status;
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    uint32_t labels[6 * 6 * 6];
    for (uint32_t i = 0; i < 6 * 6 * 6; i++) {
        labels[i] = 1 + i; /* more pieces than there is room for at first */
    }
    conus_atlas *atlas = grid_atlas(6, labels);
    struct pair pair = pair_of(atlas);
    pair_finish(&pair);
    test_every_allocation(create_pierce_destroy, atlas);
    conus_atlas_destroy(atlas);
}

/* Runs last: through all of it the driver had nothing to say. */
static void the_driver_was_silent(void **state)
{
    (void)state;
    assert_int_equal(gl_pair_messages(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pieces_of_volumes_are_those_of_rays),
        cmocka_unit_test(pieces_in_cylinders_are_those_of_rays),
        cmocka_unit_test(looks_through_cylinders_are_those_of_rays),
        cmocka_unit_test(what_blocks_has_pieces_too),
        cmocka_unit_test(a_million_pieces_come_in_portions),
        cmocka_unit_test(pieces_of_a_real_atlas_are_those_of_rays),
        cmocka_unit_test(answers_with_a_range_are_those_of_rays),
        cmocka_unit_test(every_failing_allocation_is_reported),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
