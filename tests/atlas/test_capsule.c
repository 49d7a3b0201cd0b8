/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 18: a line in one capsule. */
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "test.h"

#include <stdint.h>

struct known {
    const char *what;
    double origin[3], direction[3], a[3], b[3], radius;
    double wanted[2]; /* entry and exit; the first is above the second where the line misses */
};

/* A segment along x from 0 to 10 of radius 2, unless it says otherwise. 3, 4, 5 is the right triangle. */
static const struct known known[] = {
    {"along the axis", {-5, 0, 0}, {1, 0, 0}, {0}, {10, 0, 0}, 2, {5 - 2, 15 + 2}},
    {"along the axis, backwards", {-5, 0, 0}, {-1, 0, 0}, {0}, {10, 0, 0}, 2, {-17, -3}},
    {"along it, 1.2 beside: the balls end where x*x + 1.2*1.2 = 4",
     {-5, 1.2, 0},
     {1, 0, 0},
     {0},
     {10, 0, 0},
     2,
     {5 - 1.6, 15 + 1.6}},
    {"along it, a tangent of both balls", {-5, 2, 0}, {1, 0, 0}, {0}, {10, 0, 0}, 2, {5, 15}},
    {"along it, outside", {-5, 2.0001, 0}, {1, 0, 0}, {0}, {10, 0, 0}, 2, {1, 0}},
    {"across the middle", {5, -7, 0}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {5, 9}},
    {"across, 1.2 above", {5, -7, 1.2}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {7 - 1.6, 7 + 1.6}},
    {"a tangent of the cylinder", {5, -7, 2}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {7, 7}},
    {"just outside", {5, -7, 2.0001}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {1, 0}},
    {"across, through the ball at the end, 1.2 beyond", {11.2, -7, 0}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {5.4, 8.6}},
    {"a tangent of the end", {12, -7, 0}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {7, 7}},
    {"from inside", {5, 0, 0}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {-2, 2}},
    {"at 3:4, through the cylinder: 4/5 of the way counts across",
     {5, 0, 0},
     {0.6, 0.8, 0},
     {0},
     {10, 0, 0},
     2,
     {-2.5, 2.5}},
    {"at 3:4 from the middle of the first ball: a radius backwards, and out of the cylinder",
     {0, 0, 0},
     {0.6, 0.8, 0},
     {0},
     {10, 0, 0},
     2,
     {-2, 2.5}},
    {"a ball", {0, 0, -9}, {0, 0, 1}, {0}, {0}, 2, {7, 11}},
    {"a ball, 1.2 beside", {1.2, 0, -9}, {0, 0, 1}, {0}, {0}, 2, {9 - 1.6, 9 + 1.6}},
    {"a capsule that is shorter than its radius, across", {0.5, -9, 0}, {0, 1, 0}, {0}, {1, 0, 0}, 50, {-41, 59}},
    {"1e5 mm away", {5, -1e5, 1.2}, {0, 1, 0}, {0}, {10, 0, 0}, 2, {1e5 - 1.6, 1e5 + 1.6}},
    {"a hair of 1e-6 mm", {5, -7, 0.6e-6}, {0, 1, 0}, {0}, {10, 0, 0}, 1e-6, {7 - 0.8e-6, 7 + 0.8e-6}},
};

static void closed_forms(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        const struct known *it = &known[i];
        double got[2] = {1, 0};
        bool hit = capsule_interval(got, it->origin, it->direction, it->a, it->b, it->radius);
        print_message("%s: %.12g to %.12g\n", it->what, got[0], got[1]);
        assert_int_equal(hit, it->wanted[0] <= it->wanted[1]);
        assert_near(got[0], it->wanted[0], 2e-10); /* the last digit of 1e5 is 1.5e-11 */
        assert_near(got[1], it->wanted[1], 2e-10);
    }
}

/* Distance of a point from a segment, computed another way: it is convex along the segment, so halving finds the
 * least. */
static double distance(const double point[3], const double a[3], const double b[3])
{
    long double low = 0;
    long double high = 1;
    long double slope = 0;
    long double sum = 0;
    for (int step = 0; step < 70; step++) {
        long double middle = (low + high) / 2;
        slope = 0;
        for (int k = 0; k < 3; k++) {
            long double side = (long double)b[k] - (long double)a[k];
            slope += side * ((long double)a[k] + middle * side - (long double)point[k]);
        }
        *(slope < 0 ? &low : &high) = middle;
    }
    for (int k = 0; k < 3; k++) {
        long double side = (long double)b[k] - (long double)a[k];
        long double away = (long double)a[k] + high * side - (long double)point[k];
        sum += away * away;
    }
    return (double)sqrtl(sum);
}

struct random_ray {
    double origin[3], direction[3], a[3], b[3], radius;
};

static void random_direction(double out[3], uint64_t *random)
{
    do {
        for (int k = 0; k < 3; k++) {
            out[k] = test_random(random, -1, 1);
        }
    } while (!vec3_normalise(out, out));
}

/* A ray towards the capsule or nearly so: from near, from inside or from 1e5 mm away; now and then to a ball, or at an
 * angle of 1e-2 to 1e-15 to the axis. */
static struct random_ray random_ray(uint64_t *random)
{
    struct random_ray ray;
    double target[3];
    double axis[3];
    double shift[3];
    double kind = test_random(random, 0, 6);
    double length = kind < 1 ? 0 : exp(test_random(random, -7, 5));
    double along = test_random(random, -0.1, 1.1);
    ray.radius = exp(test_random(random, -7, 3));
    random_direction(axis, random);
    random_direction(ray.direction, random);
    random_direction(shift, random);
    if (kind > 4) {
        vec3_add_scaled(ray.direction, axis, pow(10, test_random(random, -15, -2)), ray.direction);
        vec3_normalise(ray.direction, ray.direction);
    }
    for (int k = 0; k < 3; k++) {
        ray.a[k] = test_random(random, -100, 100);
        ray.b[k] = ray.a[k] + length * axis[k];
        target[k] = ray.a[k] + along * length * axis[k] + 1.2 * ray.radius * shift[k] * test_random(random, 0, 1);
    }
    double away = kind > 3 && kind < 5 ? 1e5 : test_random(random, -1, 3) * (length + ray.radius);
    vec3_add_scaled(ray.origin, target, -away, ray.direction);
    return ray;
}

/* At both ends of the interval the distance from the segment is the radius, and between them never more. A line that
 * misses is never nearer than the radius. */
static void ends_are_a_radius_away(void **state)
{
    (void)state;
    uint64_t random = 18;
    size_t hits = 0;
    for (int i = 0; i < 20000; i++) {
        struct random_ray ray = random_ray(&random);
        double got[2];
        double point[3];
        if (!capsule_interval(got, ray.origin, ray.direction, ray.a, ray.b, ray.radius)) {
            for (int k = 0; k < 3; k++) {
                point[k] = ray.a[k] - ray.origin[k];
            }
            double middle = vec3_dot(point, ray.direction);
            for (int k = -5; k <= 5; k++) {
                vec3_add_scaled(point, ray.origin, middle + k * (ray.radius + 1), ray.direction);
                assert_true(distance(point, ray.a, ray.b) >= ray.radius - 1e-9);
            }
            continue;
        }
        hits++;
        for (int k = 0; k <= 4; k++) {
            vec3_add_scaled(point, ray.origin, got[0] + (got[1] - got[0]) * k / 4, ray.direction);
            double away = distance(point, ray.a, ray.b);
            assert_true(away <= ray.radius + 1e-9);
            assert_true(k % 4 != 0 || away >= ray.radius - 1e-9);
        }
    }
    print_message("%zu of 20000 lines hit\n", hits);
    assert_true(hits > 10000 && hits < 19500);
}

/* After a turn about the axis (2, 3, 6)/7 by an angle with the sine 0.6 and a shift, entries move by rounding only,
 * unless the line grazes. */
static void a_rigid_motion_changes_nothing(void **state)
{
    (void)state;
    static const double axis[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    uint64_t random = 19;
    double turn[16];
    mat4_identity(turn);
    for (int column = 0; column < 3; column++) {
        double e[3] = {column == 0, column == 1, column == 2};
        double cross[3];
        vec3_cross(cross, axis, e);
        for (int row = 0; row < 3; row++) { /* Rodrigues */
            turn[4 * column + row] = 0.8 * e[row] + 0.6 * cross[row] + 0.2 * axis[row] * axis[column];
        }
        turn[12 + column] = 10.0 * (column - 1);
    }
    for (int i = 0; i < 5000; i++) {
        struct random_ray ray = random_ray(&random);
        struct random_ray turned = ray;
        double got[2];
        double again[2];
        double thin = ray.radius * (1 - 1e-6);
        mat4_point(turned.origin, turn, ray.origin);
        mat4_direction(turned.direction, turn, ray.direction);
        mat4_point(turned.a, turn, ray.a);
        mat4_point(turned.b, turn, ray.b);
        if (!capsule_interval(got, ray.origin, ray.direction, ray.a, ray.b, thin)) {
            continue; /* so that no hit is a tangent */
        }
        assert_true(capsule_interval(got, ray.origin, ray.direction, ray.a, ray.b, ray.radius));
        assert_true(capsule_interval(again, turned.origin, turned.direction, turned.a, turned.b, turned.radius));
        double point[3];
        for (int k = 0; k < 2; k++) { /* along the axis, t may move; the distance from the segment does not */
            vec3_add_scaled(point, ray.origin, again[k], ray.direction);
            assert_near(distance(point, ray.a, ray.b), ray.radius, 1e-9);
        }
    }
}

TEST_GROUP(capsule)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),
        cmocka_unit_test(ends_are_a_radius_away),
        cmocka_unit_test(a_rigid_motion_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
