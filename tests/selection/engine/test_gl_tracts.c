/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines of the gl engine: the evidence and the layers of the rays engine, bit by bit (Eq. 18), alone and in
 * blocks of cones. tests/selection/engine/test_bundle_rays.c has them among voxels and triangles. */
#include "atlas/atlas.h"
#include "base/memory.h"
#include "conus/own.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "selection/engine/engine.h"
#include "test.h"
#include "tract_scene.h"

#include <string.h>

/* The cones' size is mesh_scene_random_cone()'s. */
enum { STREAMLINES = 60, POINTS = 30, CONE_SIZE = 12 };

/* Random walks from places within 10 mm of the middle. Every third is in the second of two bundles. */
static conus_atlas *make_atlas(uint64_t *random)
{
    struct tract_builder builder;
    uint32_t members[STREAMLINES];
    size_t count = 0;
    conus_atlas *atlas = mesh_scene_atlas();
    tract_begin(&builder);
    for (uint32_t s = 0; s < STREAMLINES; s++) {
        double at[3];
        for (int i = 0; i < POINTS; i++) {
            for (int a = 0; a < 3; a++) {
                at[a] = i ? at[a] + test_random(random, -1, 1) : test_random(random, -10, 10);
            }
            tract_add_point(&builder, at);
        }
        tract_end_streamline(&builder);
        if (s % 3 == 0) {
            members[count++] = s;
        }
    }
    builder.made.radius = 0.4;
    tract_add_group(&builder.made, "thirds", members, count);
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "rest"));
    return atlas;
}

/* Cones of all kinds, every fourth a cylinder, every fifth one from inside a streamline. */
static struct cone make_cone(uint64_t *random, const conus_atlas *atlas, int number)
{
    struct cone cone = mesh_scene_random_cone(random, CONE_SIZE);
    const struct tractogram *made = atlas_bundle_tractogram(atlas, 1);
    if (number % 5 == 4) {
        tractogram_point(cone.pose.world_from_device + 12, made,
                         (uint64_t)test_random(random, 0, (double)made->point_count));
    }
    if (number % 4 == 3) {
        cone.angle = 0;
        cone.radius = CONE_SIZE * test_random(random, 0.02, 0.5);
    }
    return cone;
}

static void compare_layers(const struct gl_pair *pair, const struct cone *cone)
{
    struct layers got = gl_pair_pierce(pair->gl, cone);
    struct layers wanted = gl_pair_pierce(pair->rays, cone);
    assert_int_equal(got.count, wanted.count);
    for (size_t k = 0; k < got.count; k++) {
        assert_true(gl_pair_same_interval(&got.intervals[k], &wanted.intervals[k]));
    }
    layers_finish(&got);
    layers_finish(&wanted);
}

/* Both bundles are shown, or one of them is hidden. */
static void hits_and_layers_are_the_same(void **state)
{
    (void)state;
    for (int hidden = 0; hidden < 3; hidden++) {
        enum { ROUNDS = 10 };
        uint64_t random = 17;
        conus_atlas *atlas = make_atlas(&random);
        assert_ok(conus_atlas_set_hidden(atlas, (bool[]){false, hidden == 1, hidden == 2}));
        struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
        size_t hits = 0;
        for (int i = 0; i < ROUNDS; i++) {
            struct cone cone = make_cone(&random, atlas, i);
            hits += gl_pair_same_hits(&pair, &cone);
            compare_layers(&pair, &cone);
        }
        assert_true(hits > 0);
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
}

/* Answers in a block equal those alone, and pixels that are not wanted have no object. Some cones are wide. */
static void blocks_of_cones_hit_the_same(void **state)
{
    (void)state;
    enum { COUNT = 30, EDGE = 9 };
    uint64_t random = 23;
    conus_atlas *atlas = make_atlas(&random);
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    struct evidence together[COUNT];
    struct cone cones[COUNT];
    struct evidence *out[COUNT];
    const struct cone *in[COUNT];
    bool wanted[EDGE * EDGE];
    size_t wide = 0;
    for (size_t i = 0; i < EDGE * EDGE; i++) {
        wanted[i] = test_random(&random, 0, 1) < 0.5;
    }
    for (int i = 0; i < COUNT; i++) {
        cones[i] = make_cone(&random, atlas, i);
        cones[i].resolution = EDGE;
        cones[i].tracing.wanted = i % 3 ? NULL : wanted;
        wide += cone_is_wide(&cones[i]);
        in[i] = &cones[i];
        out[i] = &together[i];
        assert_ok(evidence_init(&together[i], EDGE));
    }
    assert_ok(pair.gl->functions->trace_many(pair.gl, out, in, COUNT));
    for (int i = 0; i < COUNT; i++) {
        struct evidence alone = gl_pair_trace(pair.rays, &cones[i]);
        gl_pair_same_evidence(&together[i], &alone);
        evidence_finish(&alone);
        evidence_finish(&together[i]);
    }
    assert_true(wide > 0);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    uint64_t random = 29;
    conus_atlas *atlas = make_atlas(&random);
    struct cone cone = mesh_scene_cone((double[]){-30, 0, 0}, (double[]){0, 0, 0}, 30, 4);
    gl_pair_every_allocation(atlas, &cone, false);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(gl_tracts)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_and_layers_are_the_same),
        cmocka_unit_test(blocks_of_cones_hit_the_same),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
