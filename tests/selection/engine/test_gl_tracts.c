/* SPDX-License-Identifier: BSD-3-Clause */
/* Candidates of streamlines that the driver finds, decided on the CPU: bit by bit the answers of the rays engine (Eq.
 * 18), whether or not single precision could decide. */
#include "atlas/bundles.h"
#include "base/memory.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "selection/engine/engine.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <string.h>

/* Random walks from places within `size` mm of `middle` along each axis; each streamline occurs `copies` times. */
struct walks {
    const char *name;
    double size, middle, step, radius;
    size_t streamlines, points, copies;
    bool halves;
    double cone_size; /* mesh_scene_random_cone()'s */
};

static const struct walks all_walks[] = {
    {"walks", 10, 0, 1, 0.4, 60, 30, 1, false, 12},
    {"a bundle that the cones are inside of", 3, 0, 1, 0.5, 100, 12, 1, false, 4},
    {"thousands of capsules in a pixel", 4, 0, 2, 0.3, 3, 10, 300, false, 6},
    {"a radius above everything", 10, 0, 1, 60, 6, 10, 1, false, 30},
    {"a radius below everything", 2, 0, 1, 1e-3, 40, 30, 1, false, 3},
    {"single points", 10, 0, 1, 0.7, 300, 1, 1, false, 12},
    {"points that are all the same", 0, 0, 0, 2, 20, 3, 1, false, 6},
    {"long segments", 10, 0, 40, 0.3, 20, 6, 1, false, 30},
    {"halves", 20, 0, 1, 0.8, 60, 30, 1, true, 20},
    {"far from the middle of the world", 10, 3e5, 1, 0.5, 12, 30, 1, false, 12},
};

static uint16_t to_half(double x)
{
    enum { MANTISSA = 1 << 10 };
    int exponent = 0;
    double part = frexp(fabs(x), &exponent); /* x = part 2^exponent, 1/2 <= part < 1 */
    uint16_t sign = x < 0 ? 0x8000 : 0;
    if (exponent < -13) {
        return sign;
    }
    return (uint16_t)(sign | (exponent + 14) << 10 | ((int)(part * 2 * MANTISSA) & (MANTISSA - 1)));
}

static void use_halves(struct tractogram *made)
{
    made->halves = memory_raw(3 * made->point_count, sizeof *made->halves);
    assert_non_null(made->halves);
    for (uint64_t i = 0; i < 3 * made->point_count; i++) {
        made->halves[i] = to_half((double)made->points[i]);
    }
    memory_free(made->points);
    made->points = NULL;
}

/* Every third streamline is in the second of two bundles. */
static conus_atlas *make_atlas(const struct walks *walks, uint64_t *random)
{
    struct tract_builder builder;
    uint32_t members[400];
    size_t count = 0;
    conus_atlas *atlas = mesh_scene_atlas();
    tract_begin(&builder);
    for (size_t s = 0; s < walks->streamlines; s++) {
        double(*path)[3] = memory_raw(walks->points, sizeof *path);
        for (size_t i = 0; i < 3 * walks->points; i++) {
            double from = i < 3 ? walks->middle + test_random(random, -1, 1) * walks->size : path[i / 3 - 1][i % 3];
            path[i / 3][i % 3] = from + (i < 3 ? 0 : test_random(random, -1, 1) * walks->step);
        }
        if (s % 3 == 0) {
            members[count++] = (uint32_t)(s * walks->copies);
        }
        for (size_t copy = 0; copy < walks->copies; copy++) {
            for (size_t i = 0; i < walks->points; i++) {
                tract_add_point(&builder, path[i]);
            }
            tract_end_streamline(&builder);
        }
        memory_free(path);
    }
    builder.made.radius = walks->radius;
    tract_add_group(&builder.made, "thirds", members, count);
    if (walks->halves) {
        use_halves(&builder.made);
    }
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "rest"));
    return atlas;
}

/* Cones of all kinds, every fourth a cylinder, every fifth one from inside a streamline. */
static struct cone make_cone(uint64_t *random, const struct walks *walks, const conus_atlas *atlas, int number)
{
    struct cone cone = mesh_scene_random_cone(random, walks->cone_size);
    const struct tractogram *made = atlas_bundle_tractogram(atlas, 1);
    double *apex = cone.pose.world_from_device + 12;
    for (int a = 0; a < 3; a++) {
        apex[a] += walks->middle;
    }
    if (number % 5 == 4) {
        tractogram_point(apex, made, (uint64_t)test_random(random, 0, (double)made->point_count));
    }
    if (number % 4 == 3) {
        cone.angle = 0;
        cone.radius = walks->cone_size * test_random(random, 0.02, 0.5);
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
static void compare_walks(const struct walks *walks, int hidden)
{
    uint64_t random = 17;
    conus_atlas *atlas = make_atlas(walks, &random);
    assert_ok(conus_atlas_set_hidden(atlas, (bool[]){false, hidden == 1, hidden == 2}));
    struct gl_pair pair = gl_pair_create(atlas, CONUS_SAMPLING_EXACT);
    enum { ROUNDS = 10 };
    size_t hits = 0;
    for (int i = 0; i < ROUNDS; i++) {
        struct cone cone = make_cone(&random, walks, atlas, i);
        hits += gl_pair_same_hits(&pair, &cone);
        if (i == 3 || i == 4) {
            compare_layers(&pair, &cone);
        }
    }
    print_message("%s: %zu hits, %llu proposals\n", walks->name, hits,
                  (unsigned long long)engine_gl_proposals(pair.gl));
    assert_true(hits > 0 && engine_gl_proposals(pair.gl) > 0);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

static void the_driver_proposes_all_that_is_hit(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof all_walks / sizeof all_walks[0]; i++) {
        compare_walks(&all_walks[i], (int)(i % 3));
    }
}

/* Answers in a block equal those alone, and pixels that are not wanted have no object. Some cones are wide. */
static void blocks_of_cones_hit_the_same(void **state)
{
    (void)state;
    enum { COUNT = 30, EDGE = 9 };
    uint64_t random = 23;
    conus_atlas *atlas = make_atlas(&all_walks[0], &random);
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
        cones[i] = make_cone(&random, &all_walks[0], atlas, i);
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
    assert_true(wide > 0 && engine_gl_proposals(pair.gl) > 0);
    gl_pair_destroy(&pair);
    conus_atlas_destroy(atlas);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    uint64_t random = 29;
    conus_atlas *atlas = make_atlas(&all_walks[5], &random);
    struct cone cone = mesh_scene_cone((double[]){-30, 0, 0}, (double[]){0, 0, 0}, 30, 4);
    gl_pair_every_allocation(atlas, &cone, false);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(gl_tracts)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_driver_proposes_all_that_is_hit),
        cmocka_unit_test(blocks_of_cones_hit_the_same),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(the_driver_was_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
