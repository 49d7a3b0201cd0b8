/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses with errors (Eq. 14) against a plan's constraints, by the integrals of normal distributions; contacts, and
 * probabilities along an axis, by counting and by fine steps (Eq. 22). */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "scene.h"
#include "selection/plan/plan.h"
#include "selection/study/study.h"
#include "test.h"
#include "value_maps.h"

#include <math.h>
#include <string.h>

enum { SAMPLES = 4096 };

/* One box, [10, 20] x [10, 16] x [10, 16]. */
static conus_atlas *box(void)
{
    static const size_t dim[3] = {40, 30, 30};
    static const double cells[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0.5, 1}; /* cell i is [i, i + 1] */
    const conus_volume_info grid = scene_plain_grid(dim, cells);
    uint32_t *labels = memory_zeroed(dim[0] * dim[1] * dim[2], sizeof *labels);
    assert_non_null(labels);
    for (size_t k = 10; k < 16; k++) {
        for (size_t j = 10; j < 16; j++) {
            for (size_t i = 10; i < 20; i++) {
                labels[i + dim[0] * (j + dim[1] * k)] = 1;
            }
        }
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    memory_free(labels);
    return atlas;
}

/* Tries the needle from `at` along `along` to `far`; the result lives as long as the plan. */
static const conus_planned *try_needle(conus_plan **plan, conus_selector **selector, const conus_atlas *atlas,
                                       const conus_constraint *wants, size_t count, const conus_jitter_options *jitter,
                                       const double needle[7])
{
    conus_pose_row row = {.id = "needle", .range = {NAN, needle[6]}};
    const conus_planned *tried = NULL;
    assert_ok(conus_pose_along(&row.pose, needle, needle + 3, NULL));
    assert_ok(conus_selector_create(selector, atlas, NULL));
    assert_ok(conus_plan_create(plan, *selector, wants, count, &(conus_plan_options){.threads = 1, .jitter = jitter}));
    assert_ok(conus_plan_try(&tried, *plan, &row));
    return tried;
}

static void end(conus_plan *plan, conus_selector *selector)
{
    conus_plan_destroy(plan);
    conus_selector_destroy(selector);
}

static double below(double x)
{
    return 0.5 * erfc(-x / sqrt(2));
}

/* The entry is off by s (e0, e1); the far end moves towards the point that is off by u (e2, e3). */
static void ends_are_off_by_their_errors(void **state)
{
    (void)state;
    const conus_jitter_options options = {.entry = 2, .target = 3, .depth = 0.5};
    uint64_t seed = 3;
    for (int trial = 0; trial < 100; trial++) {
        conus_pose pose;
        conus_pose moved;
        conus_pose checked;
        double errors[JITTER_DIMENSIONS];
        double at[3];
        double along[3];
        for (int a = 0; a < 3; a++) {
            at[a] = test_random(&seed, -50, 50);
            along[a] = test_random(&seed, -1, 1);
        }
        for (int a = 0; a < JITTER_DIMENSIONS; a++) {
            errors[a] = trial ? test_random(&seed, -3, 3) : 0;
        }
        assert_ok(conus_pose_along(&pose, at, along, NULL));
        double far = 40;
        jitter_needle(&moved, &far, &pose, &options, errors);
        assert_near(far, 40 + 0.5 * errors[4], 1e-12);
        assert_ok(conus_pose_from_matrix(&checked, moved.world_from_device));
        const double *m = pose.world_from_device;
        double towards[3];
        for (int a = 0; a < 3; a++) {
            double entry = m[12 + a] + 2 * (errors[0] * m[a] + errors[1] * m[4 + a]);
            double target = m[12 + a] - 40 * m[8 + a] + 3 * (errors[2] * m[a] + errors[3] * m[4 + a]);
            assert_near(moved.world_from_device[12 + a], entry, 1e-12);
            towards[a] = target - entry;
        }
        assert_true(vec3_normalise(towards, towards));
        double axis[3];
        vec3_cross(axis, m + 8, moved.world_from_device + 8); /* the least turn leaves its axis */
        for (int a = 0; a < 3; a++) {
            assert_near(moved.world_from_device[8 + a], -towards[a], 1e-12);
        }
        for (int k = 0; k < 3; k++) {
            assert_near(vec3_dot(axis, moved.world_from_device + 4 * k), vec3_dot(axis, m + 4 * k), 1e-12);
        }
    }
}

/* The tip of a needle to x = 15 in the middle of the box is 5, 3 and 3 mm from its sides, and errors smaller than these
 * are proven to hold. A tilt of s about both axes has the Rayleigh distribution, as the distance between both ends'
 * errors; a depth is normal. Sobol points at 4096 are within 0.003 of these integrals. */
static void probabilities_are_integrals(void **state)
{
    (void)state;
    static const double needle[7] = {0, 13, 13, 1, 0, 0, 15};
    static const conus_constraint wants[] = {
        {.measure = CONUS_MEASURE_TIP, .names = "1"},
        {.kind = CONUS_CONSTRAINT_LEAN, .limit = 0.05 * 180 / MATH3_PI, .direction = {1, 0, 0}},
        {.kind = CONUS_CONSTRAINT_LENGTH, .most = 16},
    };
    const double sides = (2 * below(5 / 2.0) - 1) * pow(2 * below(3 / 2.0) - 1, 2);
    const struct {
        conus_jitter_options errors;
        double p[4]; /* of each constraint, and of all; NaN = unknown */
    } cases[] = {
        {{.samples = SAMPLES}, {1, 1, 1, 1}},
        {{.samples = SAMPLES, .shift = 2}, {sides, 1, 1, sides}},
        {{.samples = SAMPLES, .tilt = 0.04 * 180 / MATH3_PI},
         {1, 1 - exp(-0.5 * pow(0.05 / 0.04, 2)), 1, 1 - exp(-0.5 * pow(0.05 / 0.04, 2))}},
        {{.samples = SAMPLES, .depth = 2}, {2 * below(5 / 2.0) - 1, 1, below(0.5), below(0.5) - below(-2.5)}},
        {{.samples = SAMPLES, .entry = 0.3, .target = 0.4},
         {1, 1 - exp(-0.5 * pow(15 * tan(0.05) / 0.5, 2)), 1, 1 - exp(-0.5 * pow(15 * tan(0.05) / 0.5, 2))}},
    };
    conus_atlas *atlas = box();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        conus_plan *plan = NULL;
        conus_selector *selector = NULL;
        const conus_planned *tried = try_needle(&plan, &selector, atlas, wants, 3, &cases[i].errors, needle);
        assert_true(tried->feasible);
        for (int k = 0; k < 3; k++) {
            assert_near(tried->verdicts[k].p, cases[i].p[k], 0.003);
            assert_true(tried->p_ok <= tried->verdicts[k].p);
        }
        assert_near(tried->p_ok, cases[i].p[3], 0.003);
        assert_int_equal(plan_asked_of(plan)->jitter.options.samples, SAMPLES);
        end(plan, selector);
    }
    conus_plan *plan = NULL;
    conus_selector *selector = NULL;
    const conus_planned *tried = try_needle(&plan, &selector, atlas, wants, 3, NULL, needle);
    assert_true(isnan(tried->p_ok) && isnan(tried->verdicts[0].p));
    assert_null(plan_asked_of(plan)->jitter.errors);
    end(plan, selector);
    conus_atlas_destroy(atlas);
}

/* Needles are 1 mm long and 14 mm apart, so a tilt moves the outer one along itself. It begins 1 mm before the box's
 * end at y = 16, or 2.2 mm behind it. Each of its poses is tried by itself; the inner one is far from the box. */
static void an_outer_shank_moves_farther(void **state)
{
    (void)state;
    static const double shanks[2][2] = {{0, 0}, {14, 0}};
    static const conus_constraint wants[2] = {{.names = "1", .limit = 0.5},
                                              {.kind = CONUS_CONSTRAINT_AVOID, .names = "1", .limit = 1}};
    const conus_jitter_options errors = {.samples = 1024, .tilt = 0.1 * 180 / MATH3_PI};
    conus_atlas *atlas = box();
    for (int is_avoid = 0; is_avoid < 2; is_avoid++) {
        const double outer[7] = {15, is_avoid ? 18.2 : 15, 13, 0, 1, 0, 1};
        const conus_plan_options options = {.threads = 1, .jitter = &errors, .shanks = shanks[0], .shank_count = 2};
        conus_selector *selector = NULL;
        conus_plan *single = NULL;
        conus_plan *plan = NULL;
        const conus_planned *tried = try_needle(&single, &selector, atlas, &wants[is_avoid], 1, NULL, outer);
        conus_pose_row row = {.id = "fork", .range = {0, 1}, .pose = tried->pose};
        double *m = row.pose.world_from_device;
        vec3_add_scaled(m + 12, m + 12, -14, m);
        assert_ok(conus_plan_create(&plan, selector, &wants[is_avoid], 1, &options));
        assert_ok(conus_plan_try(&tried, plan, &row));
        double held = 0;
        for (uint32_t i = 0; i < errors.samples; i++) {
            const conus_planned *needle = NULL;
            conus_pose_row shank = row;
            double error[JITTER_DIMENSIONS];
            double far = 1;
            jitter_sample(error, i);
            jitter_needle(&shank.pose, &far, &row.pose, &errors, error);
            m = shank.pose.world_from_device;
            vec3_add_scaled(m + 12, m + 12, 14, m);
            assert_ok(conus_plan_try(&needle, single, &shank));
            held += needle->feasible;
        }
        assert_near(tried->verdicts[0].p, held / errors.samples, 0);
        assert_true(held > 0.5 * errors.samples && held < 0.99 * errors.samples);
        conus_plan_destroy(single);
        end(plan, selector);
    }
    conus_atlas_destroy(atlas);
}

/* Rows of two contacts from 1 mm before the far end on, 3 mm apart: depths 24, 21, 18, 15, and one at 12; the box is
 * from 10 to 20. */
static void contacts_are_counted(void **state)
{
    (void)state;
    static const double needle[7] = {0, 13, 13, 1, 0, 0, 25};
    conus_constraint want = {.measure = CONUS_MEASURE_CONTACTS, .names = "1", .limit = 4, .contacts = {9, 2, 3, 1}};
    conus_atlas *atlas = box();
    conus_plan *plan = NULL;
    conus_selector *selector = NULL;
    const conus_planned *tried = try_needle(&plan, &selector, atlas, &want, 1, NULL, needle);
    assert_near(tried->verdicts[0].value, 5, 0); /* two at 18, two at 15, one at 12 */
    assert_near(tried->verdicts[0].slack, 1, 0);
    assert_true(tried->feasible && plan_asked_of(plan)->constraints[0].has_leeway);
    assert_near(tried->leeway, 2, 1e-6); /* those at 15 are 3 mm inside, those at 18 and 12 are 2 */
    conus_pose_row row = {.id = "short", .range = {13, 25}, .pose = tried->pose};
    assert_ok(conus_plan_try(&tried, plan, &row));
    assert_near(tried->verdicts[0].value, 4, 0); /* the one at 12 is before the near end */
    row.range[1] = 21;                           /* at 20, where the box ends, 17 and 14 */
    assert_ok(conus_plan_try(&tried, plan, &row));
    assert_near(tried->verdicts[0].value, 4, 0);
    end(plan, selector);
    conus_atlas_destroy(atlas);
}

/* Adds an area of random probabilities on a turned, sheared or flipped grid. */
static void add_map(conus_atlas *atlas, uint64_t *seed, const char *name)
{
    static const size_t dim[3] = {9, 7, 8};
    conus_volume_info info = scene_grid(seed, dim);
    const conus_object area = {.kind = CONUS_KIND_AREA, .label = 1, .name = name, .abbreviation = "", .named = true};
    float *values = memory_raw(dim[0] * dim[1] * dim[2], sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++) {
        values[i] = (float)test_random(seed, 0, 1);
    }
    info.role = CONUS_ROLE_PROBABILITY;
    info.threshold = 0.25;
    assert_ok(area_of_values(atlas, &info, values, &area));
}

static double sum_at(const conus_atlas *atlas, const double needle[7], double depth)
{
    double point[3];
    double sum = 0;
    vec3_add_scaled(point, needle, depth, needle + 3);
    for (uint32_t object = 1; object <= 2; object++) {
        float p = atlas_probability(atlas, object, point);
        sum += isnan(p) ? 0 : (double)p;
    }
    return sum;
}

/* Against the mean over many points, which is off by less than the cells' ends, and at the contacts themselves. */
static void probabilities_along_an_axis(void **state)
{
    (void)state;
    enum { STEPS = 20000 };
    uint64_t seed = 17;
    for (int trial = 0; trial < 8; trial++) {
        conus_atlas *atlas = NULL;
        assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
        add_map(atlas, &seed, "A");
        add_map(atlas, &seed, "B");
        conus_pose aim = scene_pose(&seed, atlas);
        const double *m = aim.world_from_device;
        double needle[7] = {m[12], m[13], m[14], -m[8], -m[9], -m[10], 0};
        const double *grid = atlas_object_volume(atlas, 1)->info.world_from_voxel;
        double middle[3];
        mat4_point(middle, grid, (const double[]){4, 3, 3.5});
        vec3_sub(middle, middle, needle);
        needle[6] = vec3_length(middle) + 2;
        for (int a = 0; a < 3 && trial % 2; a++) { /* through the first map */
            needle[3 + a] = middle[a] / vec3_length(middle);
        }
        conus_constraint wants[2] = {
            {.measure = CONUS_MEASURE_PROBABILITY, .names = "A,B", .limit = 0.001},
            {.measure = CONUS_MEASURE_PROBABILITY, .names = "B", .limit = 0.001, .contacts = {4, 1, 1.5, 0.25}}};
        conus_plan *plan = NULL;
        conus_selector *selector = NULL;
        const conus_planned *tried = try_needle(&plan, &selector, atlas, wants, 2, NULL, needle);
        double sum = 0;
        for (int i = 0; i < STEPS; i++) {
            sum += sum_at(atlas, needle, (i + 0.5) / STEPS * needle[6]) / STEPS;
        }
        assert_near(tried->verdicts[0].value, sum, 60.0 / STEPS);
        assert_true(trial % 2 == 0 || sum > 0.01);
        double of_contacts = 0;
        for (int i = 0; i < 4; i++) {
            double point[3];
            double depth = needle[6] - 0.25 - 1.5 * i;
            vec3_add_scaled(point, needle, depth, needle + 3);
            float p = atlas_probability(atlas, 2, point);
            of_contacts += isnan(p) || depth < 0 ? 0 : (double)p / 4;
        }
        assert_near(tried->verdicts[1].value, of_contacts, 1e-9);
        end(plan, selector);
        conus_atlas_destroy(atlas);
    }
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    static const conus_constraint bad[] = {
        {.measure = CONUS_MEASURE_CONTACTS, .names = "1"},
        {.measure = CONUS_MEASURE_CONTACTS, .names = "1", .contacts = {65537, 1, 1, 1}},
        {.measure = CONUS_MEASURE_CONTACTS, .names = "1", .contacts = {4, 0, 1, 1}},
        {.measure = CONUS_MEASURE_CONTACTS, .names = "1", .contacts = {4, 1, 0, 1}},
        {.measure = CONUS_MEASURE_CONTACTS, .names = "1", .contacts = {4, 1, 1, -1}},
        {.names = "1", .contacts = {4, 1, 1, 1}},
        {.measure = CONUS_MEASURE_PROBABILITY, .names = "1", .limit = 0.5}, /* of a parcellation */
        {.measure = CONUS_MEASURE_PROBABILITY, .names = "1", .limit = 1.5},
    };
    static const conus_jitter_options errors[] = {
        {.tilt = -1 * 180 / MATH3_PI},
        {.tilt = 2 * 180 / MATH3_PI},
        {.shift = -1},
        {.shift = NAN},
        {.entry = 1e7},
        {.target = -1},
        {.depth = NAN},
        {.tilt = 0.1 * 180 / MATH3_PI, .entry = 1},
        {.shift = 1, .depth = 1},
        {.samples = 100},
        {.samples = 8},
    };
    static const conus_constraint want = {.names = "1"};
    conus_atlas *atlas = box();
    conus_selector *selector = NULL;
    conus_plan *plan = NULL;
    conus_table *jitter = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_fails(conus_plan_create(&plan, selector, &bad[i], 1, NULL), CONUS_ERROR_ARGUMENT);
    }
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
        const conus_plan_options options = {.jitter = &errors[i]};
        assert_fails(conus_plan_create(&plan, selector, &want, 1, &options), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_plan_create(&plan, selector, &want, 1, &(conus_plan_options){.rank = "p_ok"}),
                 CONUS_ERROR_ARGUMENT);
    assert_true(strstr(conus_message(), "jitter") != NULL);
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NULL));
    assert_fails(conus_jitter(&jitter, selector, &pose, degrees_from_radians(0.1), &(conus_jitter_options){.entry = 1}),
                 CONUS_ERROR_ARGUMENT);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(plan_jitter)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_are_off_by_their_errors), cmocka_unit_test(probabilities_are_integrals),
        cmocka_unit_test(an_outer_shank_moves_farther), cmocka_unit_test(contacts_are_counted),
        cmocka_unit_test(probabilities_along_an_axis),  cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
