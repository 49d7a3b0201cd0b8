/* SPDX-License-Identifier: BSD-3-Clause */
/* Segments in a region (Eq. 19): chords in closed form, borders, and random segments and boxes against a search in long
 * double that only uses the distance of a point outside of the region. */
#include "base/geometry/math3.h"
#include "selection/region/region.h"
#include "test.h"

#include <string.h>

static const double BOUND = 1e-12; /* of the coordinates' size, as the header says */

static struct region cone_region(const double origin[3], const double direction[3], double degrees)
{
    struct cone cone = {.angle = radians_from_degrees(degrees), .resolution = 16};
    struct region region;
    assert_ok(conus_pose_along(&cone.pose, origin, direction, NULL));
    region_from_cone(&region, &cone);
    return region;
}

static bool cut(double out[2], const struct region *region, const double a[3], const double b[3])
{
    double ends[2][3] = {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
    const bool inside[2] = {region_has(region, a), region_has(region, b)};
    return region_segment(out, region, ends, inside);
}

/* mm of the segment that are inside; -1 if it does not enter. */
static double inside_mm(const struct region *region, const double a[3], const double b[3])
{
    double s[2];
    double step[3];
    vec3_sub(step, b, a);
    return cut(s, region, a, b) ? (s[1] - s[0]) * vec3_length(step) : -1;
}

/* The cone opens along z with half angle h. A line through (0, 0, z) at the angle b > h to the axis meets its sides at
 * z sin h / sin(b - h) and z sin h / sin(b + h) from there: the law of sines in the triangles of apex, point and
 * side. */
static void test_cone_chords(void **state)
{
    (void)state;
    const double h = radians_from_degrees(20);
    const struct region region = cone_region((double[]){0, 0, 0}, (double[]){0, 0, 1}, 40);
    for (int degrees = 25; degrees <= 90; degrees += 5) {
        double b = radians_from_degrees(degrees);
        const double from[3] = {-200 * sin(b), 0, 30 - 200 * cos(b)};
        const double to[3] = {200 * sin(b), 0, 30 + 200 * cos(b)};
        double chord = 30 * sin(h) * (1 / sin(b - h) + 1 / sin(b + h));
        assert_near(inside_mm(&region, from, to), chord, 1e-10);
    }
    /* beside the axis: a hyperbola, x^2 = (tan h z)^2 - y^2 */
    double half = sqrt(pow(tan(h) * 30, 2) - 9);
    assert_near(inside_mm(&region, (double[]){-50, 3, 30}, (double[]){50, 3, 30}), 2 * half, 1e-11);
    /* along the axis, from before the apex */
    assert_near(inside_mm(&region, (double[]){0, 0, -10}, (double[]){0, 0, 25}), 25, 1e-12);
}

/* A line parallel to the side (sin h, 0, cos h) through (0, 0, c), c > 0, meets the other side alone, where
 * t sin h = -tan h (c + t cos h): t = -c / (2 cos h). */
static void test_parallel(void **state)
{
    (void)state;
    for (int degrees = 5; degrees < 90; degrees += 5) {
        double h = radians_from_degrees(degrees);
        const struct region region = cone_region((double[]){0, 0, 0}, (double[]){0, 0, 1}, 2 * degrees);
        const double from[3] = {-1000 * sin(h), 0, 10 - 1000 * cos(h)};
        const double to[3] = {40 * sin(h), 0, 10 + 40 * cos(h)};
        assert_near(inside_mm(&region, from, to), 40 + 10 / (2 * cos(h)), 1e-9);
    }
}

static void test_other_chords(void **state)
{
    (void)state;
    struct region region;
    region_ball(&region, (double[]){10, 20, 30}, 5); /* 3-4-5 */
    assert_near(inside_mm(&region, (double[]){-90, 23, 30}, (double[]){110, 23, 30}), 8, 1e-11);
    region = cone_region((double[]){10, 20, 30}, (double[]){0, 0, 1}, 40);
    region = (struct region){.shape = REGION_CYLINDER,
                             .cosine = 1,
                             .radius = 5,
                             .near = 0,
                             .far = INFINITY,
                             .right = {1, 0, 0},
                             .up = {0, 1, 0},
                             .axis = {0, 0, 1},
                             .origin = {10, 20, 30}};
    assert_near(inside_mm(&region, (double[]){-90, 23, 40}, (double[]){110, 23, 40}), 8, 1e-11);
    assert_near(inside_mm(&region, (double[]){10, 23, 0}, (double[]){10, 23, 100}), 70, 1e-12); /* along it */
    assert_near(inside_mm(&region, (double[]){10, 26, 0}, (double[]){10, 26, 100}), -1, 0);
    region.far = 25;
    assert_near(inside_mm(&region, (double[]){10, 23, 0}, (double[]){10, 23, 100}), 25, 1e-12);
    region.square = true;
    assert_near(inside_mm(&region, (double[]){-90, 24, 40}, (double[]){110, 24, 40}), 10, 1e-11);
    region = cone_region((double[]){0, 0, 0}, (double[]){0, 0, 1}, 90);
    region.square = true; /* |x| <= z */
    assert_near(inside_mm(&region, (double[]){-50, 29, 30}, (double[]){50, 29, 30}), 60, 1e-11);
    assert_near(inside_mm(&region, (double[]){-50, 31, 30}, (double[]){50, 31, 30}), -1, 0);
}

static void test_borders(void **state)
{
    (void)state;
    struct region region = cone_region((double[]){0, 0, 0}, (double[]){0, 0, 1}, 90);
    double s[2];
    /* wholly inside, one end inside, and a point: exact, since no equation is solved */
    assert_true(cut(s, &region, (double[]){1, 2, 30}, (double[]){-3, 1, 40}));
    assert_true(s[0] == 0 && s[1] == 1);
    assert_true(cut(s, &region, (double[]){0, 0, 8}, (double[]){0, 0, 8}) && s[0] == 0 && s[1] == 1);
    assert_false(cut(s, &region, (double[]){9, 0, 8}, (double[]){9, 0, 8}));
    assert_true(cut(s, &region, (double[]){0, 0, 8}, (double[]){0, 0, -8}) && s[0] == 0 && s[1] == 0.5);
    /* the nappe behind the apex does not belong to the cone: neither as a whole, nor where a line goes from one to the
     * other */
    assert_near(inside_mm(&region, (double[]){-50, 0, -30}, (double[]){50, 0, -30}), -1, 0);
    assert_near(inside_mm(&region, (double[]){0, 0, -40}, (double[]){0, 0, -30}), -1, 0);
    assert_near(inside_mm(&region, (double[]){1, 0, -40}, (double[]){1, 0, 40}), 39, 1e-12);
    assert_near(inside_mm(&region, (double[]){1, 0, 40}, (double[]){1, 0, -40}), 39, 1e-12);
    /* through the apex alone, and along a side */
    assert_near(inside_mm(&region, (double[]){-1, 0, 0}, (double[]){1, 0, 0}), 0, 0);
    region_ball(&region, (double[]){0, 0, 0}, 4); /* touched at one point, and missed by the least */
    assert_near(inside_mm(&region, (double[]){-8, 4, 0}, (double[]){8, 4, 0}), 0, 0);
    assert_near(inside_mm(&region, (double[]){-8, nextafter(4, 5), 0}, (double[]){8, nextafter(4, 5), 0}), -1, 0);
    /* a segment that ends at the border, and one whose line enters, but not the segment */
    assert_near(inside_mm(&region, (double[]){8, 0, 0}, (double[]){4, 0, 0}), 0, 0);
    assert_near(inside_mm(&region, (double[]){8, 0, 0}, (double[]){5, 0, 0}), -1, 0);
}

/* mm by which a point is beyond the border: its distance from the nearest tangent plane, or from an end of the range if
 * that is larger. It is a convex function of the point, 0 at the border, of slope 1 or less. */
static long double outside(const struct region *region, double ends[2][3], long double s)
{
    long double p[3];
    long double x = 0, y = 0, z = 0;
    for (int a = 0; a < 3; a++) {
        p[a] = (long double)ends[0][a] + s * ((long double)ends[1][a] - ends[0][a]) - region->origin[a];
        x += p[a] * region->right[a];
        y += p[a] * region->up[a];
        z += p[a] * region->axis[a];
    }
    if (region->shape == REGION_BALL) {
        return sqrtl(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - region->radius;
    }
    long double cosine = 1;
    long double rim = region->radius;
    if (region->shape == REGION_CONE) {
        cosine = 1 / sqrtl(1 + (long double)region->slope * region->slope);
        rim = region->slope * z;
    }
    long double away = region->square ? fmaxl(fabsl(x), fabsl(y)) : sqrtl(x * x + y * y);
    return fmaxl((away - rim) * cosine, fmaxl(region->near - z, z - region->far));
}

/* The place where the segment is deepest, by thirds, since the function is convex. */
static long double deepest(const struct region *region, double ends[2][3])
{
    long double low = 0;
    long double high = 1;
    for (int i = 0; i < 160; i++) {
        long double one = low + (high - low) / 3;
        long double other = high - (high - low) / 3;
        if (outside(region, ends, one) > outside(region, ends, other)) {
            low = one;
        } else {
            high = other;
        }
    }
    return (low + high) / 2;
}

static void random_vector(double out[3], uint64_t *seed, double size)
{
    for (int a = 0; a < 3; a++) {
        out[a] = test_random(seed, -size, size);
    }
}

/* A region of one of five shapes, with a range or without. */
static struct region random_region(uint64_t *seed, double size)
{
    struct cone cone = {.resolution = 16};
    struct region region;
    double origin[3];
    double direction[3];
    random_vector(origin, seed, size);
    random_vector(direction, seed, 1);
    int shape = (int)test_random(seed, 0, 5);
    if (shape == 4) {
        region_ball(&region, origin, test_random(seed, 0.01, 0.5) * size);
        return region;
    }
    assert_ok(conus_pose_along(&cone.pose, origin, direction, NULL));
    cone.aperture = shape & 1 ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE;
    cone.angle = shape & 2 ? 0
                           : radians_from_degrees(test_random(seed, 0, 1) < 0.2 ? test_random(seed, 170, 179.99)
                                                                                : test_random(seed, 0.01, 120));
    cone.radius = shape & 2 ? test_random(seed, 0.001, 0.5) * size : 0;
    if (test_random(seed, 0, 1) < 0.4) {
        cone.range[0] = test_random(seed, 0, 0.5) * size;
        cone.range[1] = cone.range[0] + test_random(seed, 0, 1) * size;
    }
    region_from_cone(&region, &cone);
    return region;
}

/* Segments of all lengths, some towards the apex, along the axis or along a side, or with equal ends. */
static void random_segment(double ends[2][3], uint64_t *seed, const struct region *region, double size)
{
    double length = size * pow(10, test_random(seed, -4, 0.5));
    int kind = (int)test_random(seed, 0, 8);
    random_vector(ends[0], seed, 1);
    vec3_add_scaled(ends[0], region->origin, size * pow(10, test_random(seed, -4, 0)), ends[0]);
    random_vector(ends[1], seed, 1);
    if (kind == 0) {
        vec3_sub(ends[1], region->origin, ends[0]);
    } else if (kind == 1) {
        memcpy(ends[1], region->axis, sizeof ends[1]);
    } else if (kind == 2) {
        vec3_scale(ends[1], region->axis, region->cosine);
        vec3_add_scaled(ends[1], ends[1], region->sine, region->right);
    }
    vec3_add_scaled(ends[1], ends[0], kind == 3 && length < 0.01 * size ? 0 : length, ends[1]);
}

struct tally {
    size_t in, out, whole, graze;
};

static void check_segment(struct tally *tally, const struct region *region, double ends[2][3])
{
    const bool inside[2] = {region_has(region, ends[0]), region_has(region, ends[1])};
    double s[2];
    long double allowed = BOUND * (vec3_length(ends[0]) + vec3_length(ends[1]) + vec3_length(region->origin));
    bool in = region_segment(s, region, ends, inside);
    long double at = deepest(region, ends);
    long double depth = outside(region, ends, at);
    if (fabsl(depth) <= allowed) {
        tally->graze++; /* and either answer is right, but for the conditions below */
    } else {
        assert_true(in == (depth < 0));
    }
    tally->in += in;
    tally->out += !in;
    if (!in) {
        assert_false(inside[0] || inside[1]);
        return;
    }
    tally->whole += inside[0] && inside[1];
    assert_true(s[0] >= 0 && s[0] <= s[1] && s[1] <= 1);
    assert_true(!inside[0] || s[0] == 0);
    assert_true(!inside[1] || s[1] == 1);
    for (int end = 0; end < 2; end++) { /* at the border, or where the segment ends */
        long double there = outside(region, ends, s[end]);
        assert_true(there <= allowed);
        assert_true(there >= -allowed || s[end] == end);
    }
}

static void test_random_segments(void **state)
{
    (void)state;
    uint64_t seed = 1;
    struct tally tally = {0};
    for (int i = 0; i < 30000; i++) {
        double size = pow(10, test_random(&seed, 0, i % 10 ? 2.5 : 8));
        struct region region = random_region(&seed, size);
        double ends[2][3];
        random_segment(ends, &seed, &region, size);
        check_segment(&tally, &region, ends);
    }
    print_message("%zu come in, %zu of them wholly, %zu do not; %zu graze\n", tally.in, tally.whole, tally.out,
                  tally.graze);
    assert_true(tally.in > 5000 && tally.out > 5000 && tally.whole > 1000 && tally.graze < 3000);
}

/* Segments that touch, up to some last bits: tangents of the ball and the cylinder, moved by a few bits. */
static void test_grazing(void **state)
{
    (void)state;
    uint64_t seed = 2;
    struct tally tally = {0};
    for (int i = 0; i < 10000; i++) {
        struct region region = random_region(&seed, 100);
        double ends[2][3];
        double depth;
        random_segment(ends, &seed, &region, 100);
        depth = (double)outside(&region, ends, deepest(&region, ends));
        const double shift = depth * (1 + test_random(&seed, -1, 1) * pow(10, test_random(&seed, -16, -6)));
        for (int a = 0; a < 3; a++) { /* the region moves towards the segment by the distance between them */
            double towards = ends[0][a] + (double)deepest(&region, ends) * (ends[1][a] - ends[0][a]) - region.origin[a];
            region.origin[a] += region.shape == REGION_BALL ? towards / (depth + region.radius) * shift : 0;
        }
        check_segment(&tally, &region, ends);
    }
    assert_true(tally.graze > 500);
}

static void test_boxes(void **state)
{
    (void)state;
    uint64_t seed = 3;
    size_t counts[3] = {0};
    size_t needless = 0;
    for (int i = 0; i < 20000; i++) {
        struct region region = random_region(&seed, 100);
        double low[3];
        double high[3];
        size_t in = 0;
        random_vector(low, &seed, 1);
        vec3_add_scaled(low, region.origin, 100 * pow(10, test_random(&seed, -2, 0)), low);
        for (int a = 0; a < 3; a++) {
            high[a] = low[a] + (test_random(&seed, 0, 1) < 0.1 ? 0 : pow(10, test_random(&seed, -1, 1.5)));
        }
        enum tract_answer answer = region_box(&region, low, high);
        for (int n = 0; n < 30; n++) {
            double p[3];
            for (int a = 0; a < 3; a++) { /* corners first */
                p[a] = n < 8 ? (n >> a & 1 ? high[a] : low[a]) : low[a] + test_random(&seed, 0, 1) * (high[a] - low[a]);
            }
            bool has = region_has(&region, p);
            in += has;
            assert_true(answer == TRACT_PERHAPS || has == (answer == TRACT_INSIDE));
        }
        counts[answer]++;
        needless += answer == TRACT_PERHAPS && (in == 0 || in == 30);
    }
    print_message("%zu outside, %zu perhaps (%zu of them by 30 points needlessly), %zu inside\n", counts[TRACT_OUTSIDE],
                  counts[TRACT_PERHAPS], needless, counts[TRACT_INSIDE]);
    assert_true(counts[TRACT_OUTSIDE] > 2000 && counts[TRACT_INSIDE] > 500);
    assert_true(needless < counts[TRACT_PERHAPS] / 2);
}

TEST_GROUP(region_segment)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cone_chords), cmocka_unit_test(test_parallel),        cmocka_unit_test(test_other_chords),
        cmocka_unit_test(test_borders),     cmocka_unit_test(test_random_segments), cmocka_unit_test(test_grazing),
        cmocka_unit_test(test_boxes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
