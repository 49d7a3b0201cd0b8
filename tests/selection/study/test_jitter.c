/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 14: probabilities under errors of the pose, against Gaussian integrals. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/study/study.h"
#include "tables.h"
#include "test.h"
#include "test_gl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const conus_selector_options one_ray = {.resolution = 1};

static conus_pose down_from(double x, double y, double z)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){x, y, z}, (double[]){0, 0, -1}, NULL));
    return pose;
}

/* dim[0] x dim[1] voxels in one plane, labels from 1, each edge[0] x edge[1] mm and 10 mm thick; the grid's middle is
 * at (middle, 0) and its top at z = 0. */
static conus_atlas *tiles(const size_t dim[2], const double edge[2], double middle)
{
    double m[16] = {edge[0], 0, 0, 0, 0, edge[1], 0, 0, 0, 0, 10, 0, 0, 0, -5, 1};
    uint32_t labels[64];
    m[12] = middle - edge[0] * (double)(dim[0] - 1) / 2;
    m[13] = -edge[1] * (double)(dim[1] - 1) / 2;
    for (uint32_t i = 0; i < dim[0] * dim[1]; i++) {
        labels[i] = i + 1;
    }
    const conus_volume_info grid = scene_plain_grid((size_t[]){dim[0], dim[1], 1}, m);
    return scene_parcellation(&grid, labels);
}

/* Two half-spaces that meet at x = `edge`, and a device `height` above their surface. */
static conus_atlas *half_spaces(double edge)
{
    return tiles((const size_t[]){2, 1}, (const double[]){1e5, 2e5}, edge);
}

static conus_table *jitter_of(const conus_atlas *atlas, const conus_selector_options *selector_options,
                              const conus_pose *pose, double degrees, const conus_jitter_options *options)
{
    conus_selector *selector = NULL;
    conus_table *jitter = NULL;
    assert_ok(conus_selector_create(&selector, atlas, selector_options));
    assert_ok(conus_jitter(&jitter, selector, pose, degrees, options));
    conus_selector_destroy(selector);
    return jitter;
}

/* A number of the row about an object, which has one. */
static double number_of(const conus_table *jitter, const char *column, uint32_t object)
{
    return table_number_at(jitter, column, table_row_of(jitter, object));
}

/* Sums of 1, ranks, order, numbers in their ranges; the errors that were asked. */
static void check_rows(const conus_table *jitter, bool layers)
{
    double hits = 0;
    double shares = 0;
    size_t count = conus_table_rows(jitter);
    const struct table_question *asked = table_question(jitter);
    for (size_t i = 0; i < count; i++) {
        uint32_t object = conus_table_objects(jitter)[i];
        double hit = table_number_at(jitter, "p_hit", i);
        double seen = table_number_at(jitter, "p_seen", i);
        double in_cone = table_number_at(jitter, "p_in_cone", i);
        double share = table_number_at(jitter, "mean_share", i);
        bool is_last = i + 1 == count;
        assert_int_equal(object == 0, is_last);
        assert_int_equal(table_count_at(jitter, "rank", i), object ? i + 1 : 0);
        assert_int_equal(conus_table_find(jitter, "rank")->missing[i], is_last);
        assert_int_equal(!strcmp(table_text_at(jitter, "kind", i), "unassigned"), is_last);
        assert_true(i + 2 >= count || hit >= table_number_at(jitter, "p_hit", i + 1));
        assert_true(hit >= 0 && hit <= seen + 1e-12 && seen <= 1 && table_number_at(jitter, "p_hit_error", i) >= 0);
        assert_true(layers && object ? in_cone >= seen && in_cone <= 1 : isnan(in_cone));
        assert_true(share >= 0 && share <= seen + 1e-12 && table_number_at(jitter, "sd_share", i) >= 0);
        assert_int_equal(table_count_at(jitter, "samples", i), asked->jitter.samples);
        assert_true(table_number_at(jitter, "error_deg", i) == asked->jitter.tilt);
        assert_true(table_number_at(jitter, "error_mm", i) == asked->jitter.shift);
        hits += hit;
        shares += share;
    }
    assert_near(hits, 1, 1e-12);
    assert_near(shares, 1, 1e-12);
}

static double hit_of(const conus_atlas *atlas, const conus_pose *pose, const conus_jitter_options *options,
                     uint32_t object, double *error)
{
    conus_table *jitter = jitter_of(atlas, &one_ray, pose, 1, options);
    bool has = table_row_of(jitter, object) < conus_table_rows(jitter);
    double hit = has ? number_of(jitter, "p_hit", object) : 0;
    if (error) {
        *error = has ? number_of(jitter, "p_hit_error", object) : 0;
    }
    check_rows(jitter, false);
    conus_table_destroy(jitter);
    return hit;
}

static double below(double x)
{
    return 0.5 * erfc(-x / sqrt(2));
}

static void samples_are_standard_normal(void **state)
{
    (void)state;
    enum { COUNT = 4096 };
    double sum[JITTER_DIMENSIONS] = {0};
    double square[JITTER_DIMENSIONS][JITTER_DIMENSIONS] = {{0}};
    double under[JITTER_DIMENSIONS][5] = {{0}};
    for (uint32_t i = 0; i < COUNT; i++) {
        double x[JITTER_DIMENSIONS];
        jitter_sample(x, i);
        for (int a = 0; a < JITTER_DIMENSIONS; a++) {
            sum[a] += x[a];
            for (int b = 0; b < JITTER_DIMENSIONS; b++) {
                square[a][b] += x[a] * x[b];
            }
            for (int t = 0; t < 5; t++) {
                under[a][t] += x[a] < t - 2;
            }
        }
    }
    for (int a = 0; a < JITTER_DIMENSIONS; a++) {
        assert_near(sum[a] / COUNT, 0, 0.005);
        for (int b = 0; b < JITTER_DIMENSIONS; b++) {
            assert_near(square[a][b] / COUNT, a == b, 0.02);
        }
        for (int t = 0; t < 5; t++) {
            assert_near(under[a][t] / COUNT, below(t - 2), 0.004);
        }
    }
}

/* The axis turns by the length of (tilt 0, tilt 1), away from the one and towards the other; the position moves along
 * the device's own axes. */
static void poses_move_as_the_errors_say(void **state)
{
    (void)state;
    uint64_t seed = 6;
    conus_pose pose;
    conus_pose moved;
    const conus_jitter_options options = {.tilt = 0.1 * 180 / MATH3_PI, .shift = 2};
    assert_ok(conus_pose_along(&pose, (double[]){1, 2, 3}, (double[]){1, -1, 0.5}, NULL));
    const double *m = pose.world_from_device;
    for (int i = 0; i < 100; i++) {
        double errors[JITTER_DIMENSIONS];
        for (int a = 0; a < JITTER_DIMENSIONS; a++) {
            errors[a] = test_random(&seed, -3, 3);
        }
        jitter_pose(&moved, &pose, &options, errors);
        const double *w = moved.world_from_device;
        double angle = 0.1 * hypot(errors[0], errors[1]);
        assert_near(vec3_dot(w + 8, m + 8), cos(angle), 1e-12);
        assert_near(-vec3_dot(w + 8, m), -errors[1] * sin(angle) / hypot(errors[0], errors[1]), 1e-12);
        assert_near(-vec3_dot(w + 8, m + 4), errors[0] * sin(angle) / hypot(errors[0], errors[1]), 1e-12);
        for (int a = 0; a < 3; a++) {
            double shift[3];
            vec3_sub(shift, w + 12, m + 12);
            assert_near(vec3_dot(shift, m + 4 * a), 2 * errors[2 + a], 1e-12);
            assert_near(vec3_dot(w + 4 * a, w + 4 * ((a + 1) % 3)), 0, 1e-12);
        }
        assert_near(mat4_determinant3(w), 1, 1e-12);
    }
    jitter_pose(&moved, &pose, &(conus_jitter_options){0}, (double[]){1, 2, 3, 4, 5});
    assert_memory_equal(&moved, &pose, sizeof pose);
}

static void a_shift_across_an_edge_is_a_normal_integral(void **state)
{
    (void)state;
    conus_pose pose = down_from(0, 0, 100);
    for (int edge = -8; edge <= 8; edge++) {
        conus_atlas *atlas = half_spaces(edge);
        const conus_jitter_options options = {.shift = 3};
        double error;
        double hit = hit_of(atlas, &pose, &options, 1, &error);
        assert_near(hit, below(edge / 3.0), 0.006);
        assert_near(hit, below(edge / 3.0), 5 * error + 1e-3);
        conus_atlas_destroy(atlas);
    }
}

/* With tilts (a, b) the axis meets the plane `height` below at x = -height b tan(h) / h, where h = sqrt(a^2 + b^2) has
 * the Rayleigh distribution: an integral over h of the part of the circle on which x < edge. */
static double tilted_below(double edge, double height, double tilt)
{
    enum { STEPS = 100000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double h = (i + 0.5) / STEPS * MATH3_PI / 2;
        double reach = height * tan(h);
        double part = edge >= reach ? 1 : edge <= -reach ? 0 : 0.5 + asin(edge / reach) / MATH3_PI;
        sum += part * h / (tilt * tilt) * exp(-h * h / (2 * tilt * tilt));
    }
    return sum * MATH3_PI / 2 / STEPS;
}

static void a_tilt_across_an_edge_is_one_too(void **state)
{
    (void)state;
    conus_pose pose = down_from(0, 0, 100);
    for (int edge = -30; edge <= 30; edge += 6) {
        conus_atlas *atlas = half_spaces(edge);
        const conus_jitter_options options = {.tilt = 0.1 * 180 / MATH3_PI};
        double error;
        double hit = hit_of(atlas, &pose, &options, 1, &error);
        assert_near(hit, tilted_below(edge, 100, 0.1), 0.006);
        assert_near(hit, tilted_below(edge, 100, 0.1), 5 * error + 1e-3);
        conus_atlas_destroy(atlas);
    }
}

/* Nine tiles of 8 mm: the middle one is hit if both coordinates are within 4 mm, and none if one is beyond 12. */
static void a_tile_is_a_product_of_integrals(void **state)
{
    (void)state;
    conus_pose pose = down_from(0, 0, 50);
    conus_atlas *atlas = tiles((const size_t[]){3, 3}, (const double[]){8, 8}, 0);
    const conus_jitter_options options = {.shift = 5, .samples = 4096};
    double middle = erf(4 / (5 * sqrt(2)));
    double all = erf(12 / (5 * sqrt(2)));
    assert_near(hit_of(atlas, &pose, &options, 5, NULL), middle * middle, 0.006);
    assert_near(hit_of(atlas, &pose, &options, 1, NULL), pow((all - middle) / 2, 2), 0.006);
    assert_near(hit_of(atlas, &pose, &options, 0, NULL), 1 - all * all, 0.006);
    conus_atlas_destroy(atlas);
}

/* A ball of 10 mm, far below: its disc is hit with the probability 1 - exp(-R^2 / 2 s^2). */
static void a_ball_is_rayleighs(void **state)
{
    (void)state;
    conus_pose pose = down_from(0, 0, 100);
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh mesh = mesh_scene_sphere((double[]){0, 0, 0}, 10, 100, 400);
    mesh_scene_add(atlas, &mesh);
    for (int shift = 4; shift <= 16; shift *= 2) {
        const conus_jitter_options options = {.shift = shift, .samples = 4096};
        assert_near(hit_of(atlas, &pose, &options, 1, NULL), 1 - exp(-50.0 / (shift * shift)), 0.006);
    }
    conus_atlas_destroy(atlas);
}

/* Root mean square over edges of the true error, and of the reported one. */
static void errors_with(double out[2], uint32_t samples)
{
    enum { EDGES = 15 };
    conus_pose pose = down_from(0, 0, 100);
    out[0] = out[1] = 0;
    for (int i = 0; i < EDGES; i++) {
        double edge = (i - 7) * 0.83;
        double error;
        conus_atlas *atlas = half_spaces(edge);
        const conus_jitter_options options = {.shift = 3, .samples = samples};
        double off = hit_of(atlas, &pose, &options, 1, &error) - below(edge / 3);
        out[0] += off * off / EDGES;
        out[1] += error * error / EDGES;
        conus_atlas_destroy(atlas);
    }
    out[0] = sqrt(out[0]);
    out[1] = sqrt(out[1]);
}

/* Random samples would have an error of sqrt(p (1 - p) / N). */
static void the_error_falls_faster_than_by_chance(void **state)
{
    (void)state;
    for (uint32_t samples = 64; samples <= 65536; samples *= 4) {
        double errors[2];
        errors_with(errors, samples);
        print_message("N = %5u: off by %.2g, stated %.2g, random samples %.2g\n", samples, errors[0], errors[1],
                      0.41 / sqrt(samples));
        assert_true(errors[0] < errors[1]);
        assert_true(errors[0] < 0.41 / sqrt(samples) * pow(samples / 64.0, -0.4) / 4);
    }
}

static void without_errors_there_is_one_answer(void **state)
{
    (void)state;
    const conus_selector_options rays_of_16 = {.resolution = 16}; /* the deviation is rounded to 1e-7 */
    uint64_t seed = 12;
    conus_atlas *atlas = scene_atlas(&seed, 14, 1);
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose = scene_generic_pose(&seed, atlas);
    conus_table *jitter = jitter_of(atlas, &rays_of_16, &pose, 60, &(conus_jitter_options){0});
    assert_ok(conus_selector_create(&selector, atlas, &rays_of_16));
    assert_ok(conus_select(&selection, selector, &pose, 60));
    check_rows(jitter, false);
    assert_int_equal(conus_table_rows(jitter), conus_selection_count(selection));
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        assert_true(number_of(jitter, "p_hit", result->object) == (result->rank == 1));
        assert_near(number_of(jitter, "mean_share", result->object), result->share, 1e-12);
        assert_near(number_of(jitter, "sd_share", result->object), 0, 1e-7);
        assert_true(number_of(jitter, "p_hit_error", result->object) == 0);
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_table_destroy(jitter);
    conus_atlas_destroy(atlas);
}

/* Tiles of 10 mm from x = -15 to 15. A cone of 8 mm around x = 1 holds much of 2, a strip of 4 mm of 3 and one of 2 mm
 * of 1. Tile 2 is always the best; of the other two, which never are, the one with the larger share comes first. */
static void what_is_never_best_is_ranked_by_share(void **state)
{
    (void)state;
    static const uint32_t order[3] = {2, 3, 1};
    conus_atlas *atlas = tiles((const size_t[]){3, 1}, (const double[]){10, 100}, 0);
    const conus_pose pose = down_from(1, 0, 10);
    conus_table *jitter =
        jitter_of(atlas, NULL, &pose, 2 * degrees_from_radians(atan(0.8)), &(conus_jitter_options){.samples = 16});
    check_rows(jitter, false);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(conus_table_objects(jitter)[i], order[i]);
        assert_true(table_number_at(jitter, "p_hit", i) == (i == 0));
    }
    conus_table_destroy(jitter);
    conus_atlas_destroy(atlas);
}

/* Part of a circle of radius 1 that lies on the near side of a line at the distance u from its centre. */
static double part_of_circle(double u)
{
    return fabs(u) >= 1 ? u > 0 : 0.5 + (u * sqrt(1 - u * u) + asin(u)) / MATH3_PI;
}

/* Standard deviation of part_of_circle(u) for normal u around 0, by the midpoint rule. */
static double deviation_of_part(double sigma)
{
    double sum = 0;
    const double step = 1e-4;
    for (int i = -80000; i < 80000; i++) {
        double x = (i + 0.5) * step;
        double off = part_of_circle(sigma * x) - 0.5;
        sum += off * off * exp(-x * x / 2) / sqrt(2 * MATH3_PI) * step;
    }
    return sqrt(sum);
}

/* The axis meets the plane 100 mm below at a normal distance from the edge: 2 mm of shift, and 0.02 of tilt there, too,
 * are 2 sqrt(2) mm; the circle's radius is 100 tan 5 degrees. Its 208 pixels are not quite a circle. */
static void shares_are_means(void **state)
{
    (void)state;
    conus_pose pose = down_from(0, 0, 100);
    conus_atlas *atlas = half_spaces(0);
    const conus_jitter_options options = {.shift = 2, .tilt = 0.02 * 180 / MATH3_PI, .samples = 4096};
    const conus_selector_options fine = {.resolution = 64};
    conus_table *jitter = jitter_of(atlas, &fine, &pose, 10, &options);
    double wanted = deviation_of_part(2 * sqrt(2) / (100 * tan(radians_from_degrees(5))));
    check_rows(jitter, false);
    assert_near(number_of(jitter, "mean_share", 1), 0.5, 0.0005);
    assert_near(number_of(jitter, "sd_share", 1), wanted, 0.01 * wanted);
    assert_near(number_of(jitter, "sd_share", 1), number_of(jitter, "sd_share", 2), 1e-9);
    conus_table_destroy(jitter);
    conus_atlas_destroy(atlas);
}

enum { FEW = 32 };

/* Share and hit of object 1 in each of FEW samples. */
struct samples {
    double share[FEW];
    double hit[FEW];
};

static void select_samples(struct samples *out, const conus_atlas *atlas, const conus_pose *pose, double degrees,
                           const conus_jitter_options *options)
{
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    *out = (struct samples){0};
    for (uint32_t i = 0; i < FEW; i++) {
        conus_selection *selection = NULL;
        conus_pose moved;
        double errors[JITTER_DIMENSIONS];
        jitter_sample(errors, i);
        jitter_pose(&moved, pose, options, errors);
        assert_ok(conus_select(&selection, selector, &moved, degrees));
        for (size_t r = 0; r < conus_selection_count(selection); r++) {
            const conus_result *result = conus_selection_result(selection, r);
            if (result->object == 1) {
                out->share[i] = result->share;
                out->hit[i] = result->rank == 1;
            }
        }
        conus_selection_destroy(selection);
    }
    conus_selector_destroy(selector);
}

/* The variance of a population, estimated from a sample: over n - 1 (Bessel). */
static double sample_variance(const double *values, int n)
{
    double mean = 0;
    double sum = 0;
    for (int i = 0; i < n; i++) {
        mean += values[i] / n;
    }
    for (int i = 0; i < n; i++) {
        sum += (values[i] - mean) * (values[i] - mean);
    }
    return sum / (n - 1);
}

/* The deviation of shares is the sample's; the error of a hit is that of a mean of 16 values, each the mean of the
 * FEW / 16 samples of its set. With so few of them n for n - 1 is 1.6 and 3.2 % off. */
static void deviation_and_error_are_those_of_samples(void **state)
{
    (void)state;
    conus_atlas *atlas = half_spaces(1);
    const conus_pose pose = down_from(0, 0, 100);
    const conus_jitter_options options = {.shift = 3, .tilt = 0.02 * 180 / MATH3_PI, .samples = FEW};
    struct samples samples;
    double sets[JITTER_SETS] = {0};
    conus_table *jitter = jitter_of(atlas, NULL, &pose, 10, &options);
    select_samples(&samples, atlas, &pose, 10, &options);
    for (int i = 0; i < FEW; i++) {
        sets[i * JITTER_SETS / FEW] += samples.hit[i] * JITTER_SETS / FEW;
    }
    assert_true(number_of(jitter, "p_hit", 1) > 0.2 && number_of(jitter, "p_hit", 1) < 0.95);
    assert_near(number_of(jitter, "sd_share", 1), sqrt(sample_variance(samples.share, FEW)), 1e-12);
    assert_near(number_of(jitter, "p_hit_error", 1), sqrt(sample_variance(sets, JITTER_SETS) / JITTER_SETS), 1e-12);
    conus_table_destroy(jitter);
    conus_atlas_destroy(atlas);
}

static void both_engines_say_the_same(void **state)
{
    (void)state;
    uint64_t seed = 5;
    conus_atlas *atlas = scene_atlas(&seed, 14, 1);
    const conus_selector_options by_gl = {.engine = CONUS_ENGINE_GL, .resolution = 8};
    const conus_selector_options by_rays = {.engine = CONUS_ENGINE_RAYS, .resolution = 8};
    const conus_jitter_options options = {.tilt = 0.1 * 180 / MATH3_PI, .shift = 3, .samples = 64};
    conus_selector *selector = NULL;
    assert_gl(conus_selector_create(&selector, atlas, &by_gl));
    conus_selector_destroy(selector);
    conus_pose pose = scene_generic_pose(&seed, atlas);
    conus_table *gl = jitter_of(atlas, &by_gl, &pose, 50, &options);
    conus_table *rays = jitter_of(atlas, &by_rays, &pose, 50, &options);
    assert_true(conus_table_rows(gl) > 2);
    assert_same_tables(gl, rays);
    conus_table_destroy(gl);
    conus_table_destroy(rays);
    conus_atlas_destroy(atlas);
}

static void all_layers_know_what_is_hidden(void **state)
{
    (void)state;
    uint64_t seed = 31;
    size_t hidden = 0;
    for (int i = 0; i < 20; i++) {
        conus_atlas *atlas = scene_atlas(&seed, 14, 1);
        conus_pose pose = scene_generic_pose(&seed, atlas);
        const conus_selector_options all = {.layers = CONUS_LAYERS_ALL, .resolution = 4};
        const conus_jitter_options options = {.tilt = 0.2 * 180 / MATH3_PI, .shift = 1, .samples = 32};
        conus_table *jitter = jitter_of(atlas, &all, &pose, 30, &options);
        check_rows(jitter, true);
        for (size_t r = 0; r < conus_table_rows(jitter); r++) {
            hidden += table_number_at(jitter, "p_in_cone", r) > table_number_at(jitter, "p_seen", r);
        }
        conus_table_destroy(jitter);
        conus_atlas_destroy(atlas);
    }
    assert_true(hidden > 5);
}

static void limits_are_named(void **state)
{
    (void)state;
    conus_atlas *atlas = half_spaces(0);
    conus_pose pose = down_from(0, 0, 100);
    conus_selector *selector = NULL;
    conus_table *jitter = NULL;
    static const conus_jitter_options wrong[] = {{.tilt = -1 * 180 / MATH3_PI},
                                                 {.tilt = 2 * 180 / MATH3_PI},
                                                 {.tilt = NAN},
                                                 {.shift = -1},
                                                 {.shift = NAN},
                                                 {.shift = 1e7},
                                                 {.samples = 8},
                                                 {.samples = 48},
                                                 {.samples = 1U << 21},
                                                 {.shift = INFINITY}};
    assert_ok(conus_selector_create(&selector, atlas, &one_ray));
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_fails(conus_jitter(&jitter, selector, &pose, degrees_from_radians(1), &wrong[i]), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_jitter(&jitter, selector, &pose, 0, &wrong[9]), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_jitter(&jitter, selector, &pose, NAN, &(conus_jitter_options){0}), CONUS_ERROR_ARGUMENT);
    assert_null(jitter);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Stops at the fifth pose that is reported, asserting their order. */
static bool stop_at_five(void *user, size_t done, size_t total)
{
    size_t *heard = user;
    assert_int_equal(done, ++*heard);
    assert_int_equal(total, 16);
    return done < 5;
}

static void a_callback_ends_it(void **state)
{
    (void)state;
    size_t heard = 0;
    conus_atlas *atlas = half_spaces(0);
    conus_selector *selector = NULL;
    conus_table *jitter = NULL;
    const conus_pose pose = down_from(0, 0, 100);
    const conus_jitter_options options = {.samples = 16, .progress = stop_at_five, .progress_user = &heard};
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_fails(conus_jitter(&jitter, selector, &pose, degrees_from_radians(0.2), &options), CONUS_ERROR_CANCELLED);
    assert_string_equal(conus_message(), "jitter: cancelled after 5 of 16 poses");
    assert_null(jitter);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_status make_jitter(void *data)
{
    const conus_pose pose = down_from(0, 0, 100);
    const conus_jitter_options options = {.shift = 1, .tilt = 1, .samples = 16};
    conus_selector *selector = NULL;
    conus_table *jitter = NULL;
    conus_status status = conus_selector_create(&selector, data, &(conus_selector_options){.layers = CONUS_LAYERS_ALL});
    status = status ? status : conus_jitter(&jitter, selector, &pose, 10, &options);
    assert_true(!status == (jitter != NULL));
    conus_table_destroy(jitter);
    conus_selector_destroy(selector);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = half_spaces(0);
    test_every_allocation(make_jitter, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(jitter)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_are_standard_normal),
        cmocka_unit_test(poses_move_as_the_errors_say),
        cmocka_unit_test(a_shift_across_an_edge_is_a_normal_integral),
        cmocka_unit_test(a_tilt_across_an_edge_is_one_too),
        cmocka_unit_test(a_tile_is_a_product_of_integrals),
        cmocka_unit_test(a_ball_is_rayleighs),
        cmocka_unit_test(the_error_falls_faster_than_by_chance),
        cmocka_unit_test(without_errors_there_is_one_answer),
        cmocka_unit_test(what_is_never_best_is_ranked_by_share),
        cmocka_unit_test(shares_are_means),
        cmocka_unit_test(deviation_and_error_are_those_of_samples),
        cmocka_unit_test(both_engines_say_the_same),
        cmocka_unit_test(all_layers_know_what_is_hidden),
        cmocka_unit_test(a_callback_ends_it),
        cmocka_unit_test(limits_are_named),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
