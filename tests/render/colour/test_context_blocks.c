/* SPDX-License-Identifier: BSD-3-Clause */
/* A context volume that blocks: a slab before, beside and behind a ball of voxels, a ball that is a surface, and a
 * pathway. The expected pixels follow from the same engine's answer without the slab. */
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"
#include "test_gl.h"
#include "value_maps.h"

#include <stdio.h>
#include <string.h>

enum { EDGE = 21, RESOLUTION = 48 };

static const double eye[3] = {0, -60, 0};

static conus_volume_info grid_at(conus_role role, const size_t dim[3], const double spacing[3], const double first[3])
{
    conus_volume_info info = {.role = role, .path = "grid", .slope = 1};
    double world_from_voxel[16];
    mat4_identity(world_from_voxel);
    for (size_t a = 0; a < 3; a++) {
        info.dim[a] = dim[a];
        world_from_voxel[5 * a] = spacing[a];
        world_from_voxel[12 + a] = first[a];
    }
    assert_ok(space_describe(&info, world_from_voxel, "a test"));
    return info;
}

/* A cube of EDGE mm round `centre`, with 1 in the ball in it. */
static conus_volume_info ball_at(conus_role role, const double centre[3], uint32_t labels[EDGE * EDGE * EDGE])
{
    const int half = EDGE / 2;
    for (int v = 0; v < EDGE * EDGE * EDGE; v++) {
        int i = v % EDGE - half;
        int j = v / EDGE % EDGE - half;
        int k = v / (EDGE * EDGE) - half;
        labels[v] = i * i + j * j + k * k <= half * half;
    }
    return grid_at(role, (size_t[]){EDGE, EDGE, EDGE}, (double[]){1, 1, 1},
                   (double[]){centre[0] - half, centre[1] - half, centre[2] - half});
}

static void add_pathway(conus_atlas *atlas)
{
    static uint32_t labels[EDGE * EDGE * EDGE];
    conus_volume_info info = ball_at(CONUS_ROLE_SCALAR, (double[]){0, 10, 12}, labels);
    float *values = memory_zeroed(EDGE * EDGE * EDGE, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < EDGE * EDGE * EDGE; v++) {
        values[v] = (float)labels[v];
    }
    info.threshold = 0.5;
    assert_ok(pathway_of_values(atlas, &info, values, "pathway"));
}

/* Voxels on the left, a surface on the right, both within 12 mm of the middle. */
static conus_atlas *two_balls(void)
{
    static uint32_t labels[EDGE * EDGE * EDGE];
    conus_volume_info info = ball_at(CONUS_ROLE_PARCELLATION, (double[]){-8, 0, 0}, labels);
    conus_atlas *atlas = scene_parcellation(&info, labels);
    struct mesh sphere = mesh_scene_sphere((double[]){8, 0, 0}, 10, 20, 40);
    mesh_scene_add(atlas, &sphere);
    return atlas;
}

/* Two voxels of 100 x 2 x 100 mm at the given y: one where x < 0, one where x > 0. */
static void set_slab(conus_atlas *atlas, double y, float left, float right, double threshold)
{
    conus_volume_info info =
        grid_at(CONUS_ROLE_CONTEXT, (size_t[]){2, 1, 1}, (double[]){100, 2, 100}, (double[]){-50, y, 0});
    float *values = memory_zeroed(2, sizeof *values);
    assert_non_null(values);
    values[0] = left;
    values[1] = right;
    info.threshold = threshold;
    assert_ok(atlas_set_context(atlas, &info, values));
}

/* Skips the running test if the engine needs GL and there is none. */
static conus_selection *select_from_eye(const conus_atlas *atlas, conus_selector_options options)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    options.resolution = RESOLUTION;
    assert_gl(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_pose_toward(&pose, eye, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 50));
    conus_selector_destroy(selector);
    return selection;
}

/* Fails unless `got` is `open` without the pixels of the blocked columns, [first, last). Returns the number of lost
 * pixels. */
static size_t assert_lost(const conus_selection *got, const conus_selection *open, uint32_t first, uint32_t last)
{
    const conus_evidence a = conus_selection_evidence(got);
    const conus_evidence b = conus_selection_evidence(open);
    size_t lost = 0;
    for (uint32_t pixel = 0; pixel < RESOLUTION * RESOLUTION; pixel++) {
        bool blocked = pixel % RESOLUTION >= first && pixel % RESOLUTION < last;
        assert_int_equal(a.object[pixel], blocked ? 0 : b.object[pixel]);
        assert_true(a.distance[pixel] == (blocked ? INFINITY : b.distance[pixel]));
        assert_true(a.voxel[pixel] == (blocked ? UINT64_MAX : b.voxel[pixel]));
        lost += blocked && b.object[pixel];
    }
    return lost;
}

static void check_engine(conus_selector_options options)
{
    conus_atlas *atlas = two_balls();
    conus_selection *open = select_from_eye(atlas, options);
    assert_int_equal(conus_selection_count(open), 3);
    static const struct {
        double y;
        float left, right;
        double threshold;
        uint32_t first, last; /* blocked columns */
    } slabs[] = {
        {-30, 9, 9, 0, 0, 0},                       /* no threshold: nothing blocks */
        {-30, 5, 5, 5, 0, RESOLUTION},              /* from the threshold on        */
        {-30, 5, 4.99F, 5, 0, RESOLUTION / 2},      /* voxels                       */
        {-30, 1, 9, 5, RESOLUTION / 2, RESOLUTION}, /* the surface              */
        {-60, 9, 9, 5, 0, RESOLUTION},              /* the eye inside               */
        {-90, 9, 9, 5, 0, 0},                       /* behind the eye               */
        {30, 9, 9, 5, 0, 0},                        /* behind everything            */
    };
    for (size_t i = 0; i < sizeof slabs / sizeof slabs[0]; i++) {
        set_slab(atlas, slabs[i].y, slabs[i].left, slabs[i].right, slabs[i].threshold);
        conus_selection *got = select_from_eye(atlas, options);
        size_t lost = assert_lost(got, open, slabs[i].first, slabs[i].last);
        assert_true((lost > 100) == (slabs[i].last > 0));
        conus_selection_destroy(got);
    }
    conus_selection_destroy(open);
    conus_atlas_destroy(atlas);
}

static void rays_are_stopped(void **state)
{
    (void)state;
    check_engine((conus_selector_options){.engine = CONUS_ENGINE_RAYS});
    check_engine((conus_selector_options){.engine = CONUS_ENGINE_RAYS, .sampling = CONUS_SAMPLING_SLICES});
}

static void gl_is_stopped(void **state)
{
    (void)state;
    check_engine((conus_selector_options){.engine = CONUS_ENGINE_GL});
    check_engine((conus_selector_options){.engine = CONUS_ENGINE_GL, .sampling = CONUS_SAMPLING_SLICES});
}

static void what_is_blocked_is_unassigned(void **state)
{
    (void)state;
    conus_atlas *atlas = two_balls();
    set_slab(atlas, -30, 9, 9, 5);
    conus_selection *none = select_from_eye(atlas, (conus_selector_options){0});
    assert_int_equal(conus_selection_count(none), 1);
    const conus_result *result = conus_selection_result(none, 0);
    assert_int_equal(result->kind, CONUS_KIND_UNASSIGNED);
    assert_near(result->share, 1, 1e-12);
    double position[3];
    conus_selection_position(position, none, RESOLUTION * RESOLUTION / 2);
    assert_true(isnan(position[0]));
    conus_selection_destroy(none);

    set_slab(atlas, -30, 9, 1, 5);
    conus_selection *half = select_from_eye(atlas, (conus_selector_options){0});
    assert_int_equal(conus_selection_count(half), 2);
    assert_int_equal(conus_selection_result(half, 0)->object, 2);
    assert_true(conus_selection_result(half, 1)->share > 0.5);
    conus_selection_destroy(half);
    conus_atlas_destroy(atlas);
}

/* Objects that come after the context have numbers behind it. */
static void a_pathway_may_come_after_the_context(void **state)
{
    (void)state;
    conus_atlas *atlas = two_balls();
    add_pathway(atlas);
    conus_selection *open = select_from_eye(atlas, (conus_selector_options){0});
    conus_atlas_destroy(atlas);
    atlas = two_balls();
    set_slab(atlas, -30, 9, 1, 5);
    add_pathway(atlas);
    conus_selection *got = select_from_eye(atlas, (conus_selector_options){0});
    assert_int_equal(conus_selection_count(got), 3);
    assert_true(assert_lost(got, open, 0, RESOLUTION / 2) > 100);
    conus_selection_destroy(got);
    conus_selection_destroy(open);
    conus_atlas_destroy(atlas);
}

/* A context that holds the areas themselves, as a T1 does, hides only objects behind its surface. */
static void areas_win_over_a_context_at_the_same_depth(void **state)
{
    (void)state;
    static uint32_t labels[EDGE * EDGE * EDGE];
    conus_atlas *atlas = two_balls();
    conus_selection *open = select_from_eye(atlas, (conus_selector_options){0});
    conus_volume_info info = ball_at(CONUS_ROLE_CONTEXT, (double[]){-8, 0, 0}, labels);
    float *values = memory_zeroed(EDGE * EDGE * EDGE, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < EDGE * EDGE * EDGE; v++) {
        values[v] = (float)labels[v];
    }
    info.threshold = 1;
    assert_ok(atlas_set_context(atlas, &info, values));
    conus_selection *got = select_from_eye(atlas, (conus_selector_options){0});
    assert_lost(got, open, 0, 0);
    conus_selection_destroy(got);
    conus_selection_destroy(open);
    conus_atlas_destroy(atlas);
}

static conus_status set_context(void *data)
{
    conus_atlas *atlas = data;
    conus_volume_info info = grid_at(CONUS_ROLE_CONTEXT, (size_t[]){1, 1, 1}, (double[]){1, 1, 1}, (double[]){0, 0, 0});
    float *values = memory_zeroed(1, sizeof *values);
    info.threshold = 1;
    conus_status status = values ? atlas_set_context(atlas, &info, values) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(values);
    }
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    conus_atlas *atlas = two_balls();
    test_every_allocation(set_context, atlas);
    assert_int_equal(conus_atlas_volume_count(atlas), 2);
    conus_atlas_destroy(atlas);
}

static void a_threshold_that_nothing_reaches_is_refused(void **state)
{
    (void)state;
    const char *folder = test_scratch("context_blocks");
    char path[512];
    conus_atlas *atlas = two_balls();
    assert_ok(conus_phantom_write("sphere", folder, &(conus_phantom_options){.size = 16}));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", folder);
    static const double wrong[] = {-1, 1.5, NAN, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        assert_fails(conus_atlas_set_context(atlas, path, &(conus_context_options){.block_threshold = wrong[i]}),
                     CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), "allowed is above 0 to 1, the largest value (0 = never)"));
    }
    assert_int_equal(conus_atlas_volume_count(atlas), 1);
    assert_ok(conus_atlas_set_context(atlas, path, &(conus_context_options){.block_threshold = 1}));
    assert_near(conus_atlas_volume(atlas, 1)->threshold, 1, 0);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(context_blocks)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_stopped),
        cmocka_unit_test(gl_is_stopped),
        cmocka_unit_test(what_is_blocked_is_unassigned),
        cmocka_unit_test(a_pathway_may_come_after_the_context),
        cmocka_unit_test(areas_win_over_a_context_at_the_same_depth),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(a_threshold_that_nothing_reaches_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
