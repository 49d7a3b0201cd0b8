/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays, apertures and checks of cones. */
#include "base/geometry/math3.h"
#include "selection/cone/cone.h"
#include "test.h"

static struct cone looking_down(double degrees, uint32_t resolution)
{
    struct cone cone = {.degrees = degrees, .angle = radians_from_degrees(degrees), .resolution = resolution};
    mat4_identity(cone.pose.world_from_device);
    return cone;
}

/* Eq. 3: 208 of 16 x 16 pixel centres lie in the circle. */
static void circle_has_208_of_256_pixels(void **state)
{
    (void)state;
    struct cone cone = looking_down(10, 16);
    int round = 0;
    int square = 0;
    for (uint32_t j = 0; j < 16; j++) {
        for (uint32_t i = 0; i < 16; i++) {
            cone.aperture = CONUS_APERTURE_CIRCLE;
            round += cone_has_pixel(&cone, i, j);
            cone.aperture = CONUS_APERTURE_SQUARE;
            square += cone_has_pixel(&cone, i, j);
        }
    }
    assert_int_equal(round, 208);
    assert_int_equal(square, 256);
}

/* Eq. 3: a ray at radius r leaves the axis by atan(r tan(angle / 2)), and has length 1. */
static void rays_leave_the_axis_by_their_radius(void **state)
{
    (void)state;
    struct cone cone = looking_down(50, 7);
    for (uint32_t j = 0; j < 7; j++) {
        for (uint32_t i = 0; i < 7; i++) {
            double ray[3];
            cone_ray(ray, &cone, i, j);
            double off = atan(cone_radius(&cone, i, j) * tan(radians_from_degrees(25)));
            assert_near(vec3_length(ray), 1, 1e-15);
            assert_near(acos(-ray[2]), off, 1e-7);
        }
    }
    double axis[3];
    cone_ray(axis, &cone, 3, 3);
    assert_near(axis[2], -1, 0);
}

/* Eq. 4: over the square buffer the weights, times the pixel's area on the plane at distance 1, sum to the solid angle
 * of a square pyramid, 4 asin(sin^2(angle / 2)) (Khadjavi 1968). */
static void weights_sum_to_the_solid_angle(void **state)
{
    (void)state;
    uint32_t n = 400;
    struct cone cone = looking_down(70, n);
    double slope = tan(cone.angle / 2);
    double sum = 0;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            sum += cone_weight(&cone, i, j) * 4 * slope * slope / ((double)n * n);
        }
    }
    assert_near(sum, 4 * asin(sin(cone.angle / 2) * sin(cone.angle / 2)), 1e-5);
}

/* Each pixel in the cone once in both orders, its ray with the bits of cone_ray(). */
static void check_rays(const struct aperture *aperture, const struct cone *cone)
{
    enum { AT_ONCE = 5 };
    bool listed[40 * 40] = {false};
    size_t count = aperture->rays.count;
    double axes[3][AT_ONCE];
    double *const out[3] = {axes[0], axes[1], axes[2]};
    for (size_t k = 0; k < count; k++) {
        uint32_t pixel = aperture->rays.pixel[k];
        double ray[3];
        assert_true(cone_has_pixel(cone, pixel % cone->resolution, pixel / cone->resolution) && !listed[pixel]);
        assert_true(k == 0 || aperture->inside[k] > aperture->inside[k - 1]);
        assert_true(
            cone_has_pixel(cone, aperture->inside[k] % cone->resolution, aperture->inside[k] / cone->resolution));
        listed[pixel] = true;
        size_t first = k / AT_ONCE * AT_ONCE;
        cone_rays_from(out, cone, &aperture->rays, first, count - first < AT_ONCE ? count - first : AT_ONCE);
        cone_ray(ray, cone, pixel % cone->resolution, pixel / cone->resolution);
        for (int a = 0; a < 3; a++) {
            assert_true(axes[a][k - first] == ray[a]);
        }
    }
    for (uint32_t pixel = 0; pixel < cone->resolution * cone->resolution; pixel++) {
        count -= cone_has_pixel(cone, pixel % cone->resolution, pixel / cone->resolution);
    }
    assert_int_equal(count, 0);
}

static void check_aperture(struct aperture *aperture, const struct cone *cone)
{
    double total = 0;
    assert_ok(aperture_prepare(aperture, cone));
    for (uint32_t pixel = 0; pixel < cone->resolution * cone->resolution; pixel++) {
        uint32_t i = pixel % cone->resolution;
        uint32_t j = pixel / cone->resolution;
        assert_int_equal(aperture->in_cone[pixel], cone_has_pixel(cone, i, j));
        assert_int_equal(aperture->square[pixel], cone_square(i, j, cone->resolution));
        double weight = cone_weight(cone, i, j);
        weight = cone->resolution > 16 ? nearbyint(ldexp(weight, 32)) / 4294967296 : weight; /* Eq. 4 */
        assert_true(aperture->weight[pixel] == weight);
        total += cone_has_pixel(cone, i, j) ? weight : 0;
    }
    assert_true(aperture->total_weight == total);
    check_rays(aperture, cone);
}

static void apertures_follow_their_cones(void **state)
{
    (void)state;
    struct aperture aperture = {0};
    static const double angles[] = {20, 20, 35, 0, 20, 170};
    for (size_t i = 0; i < 4 * sizeof angles / sizeof angles[0]; i++) {
        struct cone cone = looking_down(angles[i / 4], i % 3 == 0 ? 7 : i % 3 == 1 ? 16 : 37);
        cone.aperture = i % 4 == 3 ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE;
        check_aperture(&aperture, &cone);
        cone.slope = tan(cone.angle / 2);
        check_aperture(&aperture, &cone);
    }
    aperture_finish(&aperture);
}

static void impossible_cones_are_refused(void **state)
{
    (void)state;
    const double angles[] = {0, -5, 180, 200, NAN, INFINITY};
    for (size_t i = 0; i < sizeof angles / sizeof angles[0]; i++) {
        struct cone cone = looking_down(angles[i], 16);
        assert_fails(cone_check(&cone), CONUS_ERROR_ARGUMENT);
    }
    struct cone cone = looking_down(179.9, 0);
    assert_fails(cone_check(&cone), CONUS_ERROR_ARGUMENT);
    cone.resolution = 1025;
    assert_fails(cone_check(&cone), CONUS_ERROR_ARGUMENT);
    cone.resolution = 1024;
    assert_ok(cone_check(&cone));
}

TEST_GROUP(cone)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circle_has_208_of_256_pixels),   cmocka_unit_test(rays_leave_the_axis_by_their_radius),
        cmocka_unit_test(weights_sum_to_the_solid_angle), cmocka_unit_test(apertures_follow_their_cones),
        cmocka_unit_test(impossible_cones_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
