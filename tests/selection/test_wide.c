/* SPDX-License-Identifier: BSD-3-Clause */
/* Cones of more than 120 degrees (Eq. 15), whose rays are spread evenly in angle: against angles, solid angles and
 * volumes in closed form, and coarse buffers against fine ones. */
#include "base/geometry/math3.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/cone/cone.h"
#include "selection/region/region.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

static struct cone looking_down(double degrees, uint32_t n)
{
    struct cone cone = {.angle = radians_from_degrees(degrees), .resolution = n};
    assert_ok(conus_pose_along(&cone.pose, (double[]){3, -4, 5}, (double[]){0, 0, -1}, NULL));
    return cone;
}

/* The z axis of the world is the device's; x and y keep their angle about it. */
static void rays_are_evenly_spread_in_angle(void **state)
{
    (void)state;
    static const double angles[] = {120.001, 150, 179, 179.9999};
    for (size_t a = 0; a < sizeof angles / sizeof angles[0]; a++) {
        const struct cone cone = looking_down(angles[a], 17);
        const double *m = cone.pose.world_from_device;
        for (uint32_t pixel = 0; pixel < 17 * 17; pixel++) {
            uint32_t i = pixel % 17;
            uint32_t j = pixel / 17;
            double ray[3];
            double r = hypot(i - 8.0, j - 8.0) / 8.5;
            double off = r * radians_from_degrees(angles[a]) / 2;
            cone_ray(ray, &cone, i, j);
            assert_near(vec3_length(ray), 1, 1e-15);
            assert_near(vec3_dot(ray, m) * 8.5 * r, sin(off) * (i - 8.0), 1e-13);
            assert_near(vec3_dot(ray, m + 4) * 8.5 * r, sin(off) * (j - 8.0), 1e-13);
            assert_near(-vec3_dot(ray, m + 8), cos(off), 1e-15);
            assert_near(cone_off_axis(&cone, cone_radius(&cone, i, j)), off, 1e-14);
            if (off < 1.5) {
                assert_near(cone_per_depth(&cone, i, j) * cos(off), 1, 1e-13);
            }
        }
    }
}

/* Bit by bit the rays of Eq. 3, computed the same way. */
static void up_to_120_degrees_they_are_a_perspective_pictures(void **state)
{
    (void)state;
    static const double angles[] = {1, 60, 119.9, 120};
    for (size_t a = 0; a < sizeof angles / sizeof angles[0]; a++) {
        const struct cone cone = looking_down(angles[a], 16);
        double slope = tan(cone.angle / 2);
        assert_false(cone_is_wide(&cone));
        for (uint32_t pixel = 0; pixel < 256; pixel++) {
            const uint32_t row = pixel / 16;
            double x = ((2.0 * (pixel % 16) + 1) / 16 - 1) * slope;
            double y = ((2.0 * row + 1) / 16 - 1) * slope;
            double scale = 1 / sqrt(x * x + y * y + 1);
            const double *m = cone.pose.world_from_device;
            double ray[3];
            cone_ray(ray, &cone, pixel % 16, pixel / 16);
            for (int k = 0; k < 3; k++) {
                assert_true(ray[k] == m[k] * (x * scale) + m[4 + k] * (y * scale) - m[8 + k] * scale);
            }
        }
    }
    const struct cone rounded = {.angle = 2 * atan(sqrt(3)), .resolution = 16};
    const struct cone wide = {.angle = radians_from_degrees(120.00001), .resolution = 16};
    assert_false(cone_is_wide(&rounded));
    assert_true(cone_is_wide(&wide));
}

/* The reason for the limit: in perspective a pixel on the axis covers tan^2 h / (2 (1 - cos h)) of the mean solid angle
 * of a cone with half angle h, which is 3 for 60 degrees; spread evenly it covers h^2 / (2 (1 - cos h)), pi^2 / 8 at
 * most. */
static void the_limit_is_where_a_pixel_on_the_axis_covers_three_times_the_mean(void **state)
{
    (void)state;
    enum { N = 501 };
    static const struct {
        double degrees, wanted;
    } cases[] = {{120, 3}, {120.001, 1.0966}, {179.9999, MATH3_PI * MATH3_PI / 8}};
    for (size_t c = 0; c < 3; c++) {
        const struct cone cone = looking_down(cases[c].degrees, N);
        double centre[3];
        double right[3];
        double up[3];
        cone_ray(centre, &cone, N / 2, N / 2);
        cone_ray(right, &cone, N / 2 + 1, N / 2);
        cone_ray(up, &cone, N / 2, N / 2 + 1);
        double pixel = vec3_dot(right, cone.pose.world_from_device) * vec3_dot(up, cone.pose.world_from_device + 4);
        double mean = 2 * MATH3_PI * (1 - cos(cone.angle / 2)) / (MATH3_PI / 4 * N * N);
        assert_near(pixel / mean, cases[c].wanted, 2e-3);
        assert_near(vec3_dot(centre, cone.pose.world_from_device + 8), -1, 1e-15);
    }
}

/* The midpoint rule: in the buffer's plane a pixel is (2/n)^2 large, and h^2 w of solid angle per area. */
static double solid_angle(const struct cone *cone)
{
    double sum = 0;
    double half = cone->angle / 2;
    for (uint32_t pixel = 0; pixel < cone->resolution * cone->resolution; pixel++) {
        uint32_t i = pixel % cone->resolution;
        uint32_t j = pixel / cone->resolution;
        sum += cone_has_pixel(cone, i, j) ? cone_weight(cone, i, j) : 0;
    }
    return sum * half * half * 4 / cone->resolution / cone->resolution;
}

/* The cap's, 2 pi (1 - cos h); and the pyramid's, 4 asin(sin^2 h), in whose corners pixels are left out. */
static void weights_sum_to_the_solid_angle(void **state)
{
    (void)state;
    for (int degrees = 121; degrees < 180; degrees += 7) {
        struct cone cone = looking_down(degrees, 400);
        double half = cone.angle / 2;
        assert_near(solid_angle(&cone) / (2 * MATH3_PI * (1 - cos(half))), 1, 1e-3);
        cone.aperture = CONUS_APERTURE_SQUARE;
        assert_near(solid_angle(&cone) / (4 * asin(sin(half) * sin(half))), 1, 1e-3);
    }
}

/* Rays and the census (Eq. 10) agree on the voxels in the cone, except at the border itself. */
static void pixels_in_it_are_those_whose_rays_are(void **state)
{
    (void)state;
    for (int square = 0; square < 2; square++) {
        for (int degrees = 125; degrees < 180; degrees += 9) {
            struct cone cone = looking_down(degrees, 37);
            struct region region;
            uint32_t inside = 0;
            cone.aperture = square ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE;
            region_from_cone(&region, &cone);
            for (uint32_t pixel = 0; pixel < 37 * 37; pixel++) {
                double ray[3];
                double point[3];
                cone_ray(ray, &cone, pixel % 37, pixel / 37);
                vec3_add_scaled(point, cone.pose.world_from_device + 12, 50, ray);
                assert_int_equal(cone_has_pixel(&cone, pixel % 37, pixel / 37), region_has(&region, point));
                inside += cone_has_pixel(&cone, pixel % 37, pixel / 37);
            }
            assert_true(inside > 1000 && inside < 37 * 37);
        }
    }
}

/* The pixels of a wide square depend on its angle: none may remain from the cone before. */
static void apertures_follow_the_angle(void **state)
{
    (void)state;
    static const double angles[] = {170, 130, 130, 90, 175, 60, 121};
    struct aperture aperture = {0};
    for (size_t a = 0; a < sizeof angles / sizeof angles[0]; a++) {
        struct cone cone = looking_down(angles[a], 20);
        double total = 0;
        size_t count = 0;
        cone.aperture = CONUS_APERTURE_SQUARE;
        assert_ok(aperture_prepare(&aperture, &cone));
        for (uint32_t pixel = 0; pixel < 400; pixel++) {
            bool has = cone_has_pixel(&cone, pixel % 20, pixel / 20);
            assert_int_equal(aperture.in_cone[pixel], has);
            double weight = cone_weight(&cone, pixel % 20, pixel / 20);
            assert_true(aperture.weight[pixel] == nearbyint(ldexp(weight, 32)) / 4294967296); /* Eq. 4 */
            total += has ? aperture.weight[pixel] : 0;
            count += has;
        }
        assert_true(aperture.total_weight == total);
        assert_int_equal(aperture.rays.count, count);
        for (size_t k = 0; k < count; k++) {
            double ray[3];
            uint32_t pixel = aperture.rays.pixel[k];
            cone_ray(ray, &cone, pixel % 20, pixel / 20);
            assert_near(aperture.rays.forward[k], -vec3_dot(ray, cone.pose.world_from_device + 8), 1e-15);
        }
    }
    aperture_finish(&aperture);
}

static const conus_result *result_of(const conus_selection *selection, uint32_t object)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        if (conus_selection_result(selection, i)->object == object) {
            return conus_selection_result(selection, i);
        }
    }
    return NULL;
}

static double share_of(const conus_selection *selection, uint32_t object)
{
    const conus_result *result = result_of(selection, object);
    return result ? result->share : 0;
}

static void add(conus_atlas *atlas, struct mesh mesh)
{
    mesh_scene_add(atlas, &mesh);
}

/* The share of a ball of 20 mm, `away` mm from the apex and `beside` off the axis, in n x n pixels. */
static double share_of_ball(conus_selector *selector, double away, double beside, double half, uint32_t n)
{
    conus_selection *selection = NULL;
    struct cone cone = mesh_scene_cone((double[]){0, 0, 0}, (double[]){1, 2, 3}, 90, n);
    double m[16];
    memcpy(m, cone.pose.world_from_device, sizeof m);
    for (int a = 0; a < 3; a++) {
        cone.pose.world_from_device[12 + a] = away * (cos(beside) * m[8 + a] - sin(beside) * m[a]);
    }
    assert_ok(conus_select(&selection, selector, &cone.pose, degrees_from_radians(2 * half)));
    double share = share_of(selection, 1);
    conus_selection_destroy(selection);
    return share;
}

/* Root mean square of the errors of n x n pixels, for cones of some angles, and the largest in *most. Seen from 40 mm
 * the ball's rim is 30 degrees off its middle: its share of the cone is (1 - cos 30) / (1 - cos h) wherever in the cone
 * it is. */
static double error_of_ball(const conus_atlas *atlas, int first, int last, uint32_t n, double *most)
{
    const conus_selector_options options = {.resolution = n};
    conus_selector *selector = NULL;
    uint64_t random = 5;
    double square = 0;
    int count = 0;
    *most = 0;
    assert_ok(conus_selector_create(&selector, atlas, &options));
    for (int degrees = first; degrees <= last; degrees += 4) {
        for (int k = 0; k < 6; k++, count++) {
            double half = radians_from_degrees(degrees) / 2;
            double beside = test_random(&random, 0, half - MATH3_PI / 6); /* all of it is in the cone */
            double wanted = (1 - sqrt(3) / 2) / (1 - cos(half));
            double off = share_of_ball(selector, 40, beside, half, n) - wanted;
            square += off * off;
            *most = fmax(*most, fabs(off));
        }
    }
    conus_selector_destroy(selector);
    return sqrt(square / count);
}

/* 208 pixels cover 3.4 % more than their circle, and the ball's rim passes through some 30 pixels of half a point each.
 * The best that 16 x 16 can reach is their accuracy in perspective, for the cones of 80 to 116 degrees. */
static void a_ball_has_its_solid_angle(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    double most[3];
    add(atlas, mesh_scene_sphere((double[]){0, 0, 0}, 20, 90, 180));
    double narrow = error_of_ball(atlas, 80, 116, 16, &most[0]);
    double wide = error_of_ball(atlas, 122, 178, 16, &most[1]);
    double fine = error_of_ball(atlas, 122, 178, 256, &most[2]);
    print_message("a ball's share: off by %.2f points (at most %.2f) up to 116 degrees, %.2f (%.2f) from 122 on, with "
                  "256 x 256 pixels %.3f (%.3f)\n",
                  100 * narrow, 100 * most[0], 100 * wide, 100 * most[1], 100 * fine, 100 * most[2]);
    assert_true(wide < narrow && most[1] < most[0]);
    assert_true(fine < 0.001 && most[2] < 0.002);
    conus_atlas_destroy(atlas);
}

/* With the square aperture the same ball has its part of 4 asin(sin^2 h). */
static void a_ball_in_a_pyramid_too(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add(atlas, mesh_scene_sphere((double[]){0, 0, 0}, 20, 90, 180));
    for (int degrees = 125; degrees < 180; degrees += 18) {
        const struct cone cone = mesh_scene_cone((double[]){8, 24, 0}, (double[]){0, 0, 0}, degrees, 128);
        const conus_selector_options options = {.resolution = 128, .aperture = CONUS_APERTURE_SQUARE};
        conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
        double cosine = sqrt(1 - 20.0 * 20 / (8 * 8 + 24 * 24));
        double sine = sin(cone.angle / 2);
        assert_near(share_of(selection, 1), 2 * MATH3_PI * (1 - cosine) / (4 * asin(sine * sine)), 0.003);
        conus_selection_destroy(selection);
    }
    conus_atlas_destroy(atlas);
}

/* Volume by the rays (Eq. 10): a ball that is wholly in the cone, and one around the apex, of which the cone's part of
 * the full angle is in it. Contact, its angle and the values that depend on it. */
static void volumes_and_scores_follow(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add(atlas, mesh_scene_sphere((double[]){0, 0, 0}, 20, 90, 180));
    const double whole = 4 * MATH3_PI / 3 * 8000;
    const conus_selector_options options = {.resolution = 128, .layers = CONUS_LAYERS_ALL, .score = "centre"};
    struct cone cone = mesh_scene_cone((double[]){0, 0, 60}, (double[]){40, 0, 0}, 165, 128);
    conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
    const conus_result *ball = result_of(selection, 1);
    assert_near(ball->volume / whole, 1, 0.01);
    /* The ball's centre is atan(40 / 60) off the axis, its rim asin(1/3) nearer. */
    double least = atan2(40, 60) - asin(20.0 / 60);
    assert_near(radians_from_degrees(ball->offset), least, radians_from_degrees(165) / 128);
    assert_near(ball->score, 1 - radians_from_degrees(ball->offset) / (cone.angle / 2), 1e-12);
    assert_near(ball->centre_px, radians_from_degrees(ball->offset) / (cone.angle / 2) * 64, 1e-9);
    double way[3];
    vec3_sub(way, ball->contact, cone.pose.world_from_device + 12);
    assert_near(acos(-vec3_dot(way, cone.pose.world_from_device + 8) / vec3_length(way)),
                radians_from_degrees(ball->offset), 1e-9);
    conus_selection_destroy(selection);
    cone = mesh_scene_cone((double[]){0, 0, 0}, (double[]){1, 1, 0}, 165, 128);
    selection = mesh_scene_select(atlas, &options, &cone);
    assert_near(result_of(selection, 1)->volume / whole, (1 - cos(cone.angle / 2)) / 2, 0.005);
    assert_near(share_of(selection, 1), 1, 1e-12);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

/* A range is one of depths along the axis, however far a ray is from it: all intervals begin and end at its planes. */
static void a_range_cuts_at_planes(void **state)
{
    (void)state;
    uint32_t labels[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    const double m[16] = {1000, 0, 0, 0, 0, 1000, 0, 0, 0, 0, 1000, 0, -500, -500, -500, 1};
    const conus_volume_info grid = scene_plain_grid((size_t[]){2, 2, 2}, m);
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    const struct cone cone = mesh_scene_cone((double[]){1, 2, 3}, (double[]){4, 7, 9}, 160, 24);
    for (int square = 0; square < 2; square++) {
        const conus_selector_options options = {.resolution = 24,
                                                .layers = CONUS_LAYERS_ALL,
                                                .range = {12, 15},
                                                .aperture = square ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE};
        conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
        size_t count;
        const conus_interval *intervals = conus_selection_intervals(&count, selection);
        const conus_evidence evidence = conus_selection_evidence(selection);
        for (size_t s = 0; s < count; s++) {
            double ray[3];
            cone_ray(ray, &cone, intervals[s].pixel % 24, intervals[s].pixel / 24);
            double depth = -vec3_dot(ray, cone.pose.world_from_device + 8);
            assert_true(evidence.in_cone[intervals[s].pixel]);
            assert_near(intervals[s].entry * depth, 12, 1e-9);
            assert_near(intervals[s].exit * depth, 15, 1e-9);
        }
        assert_int_equal(count, result_of(selection, 1)->pixels);
        assert_near(share_of(selection, 1), 1, 1e-12);
        conus_selection_destroy(selection);
    }
    conus_atlas_destroy(atlas);
}

static void assert_same_evidence(const struct evidence *a, const struct evidence *b)
{
    for (size_t pixel = 0; pixel < (size_t)a->resolution * a->resolution; pixel++) {
        assert_int_equal(a->object[pixel], b->object[pixel]);
        assert_true(a->distance[pixel] == b->distance[pixel]);
        assert_true(a->voxel[pixel] == b->voxel[pixel]);
    }
}

enum { CONES = 6, N = 16 };

/* Narrow and wide cones in one trace, as a batch's block may have them. In narrow ones the driver may take the triangle
 * beside an edge, so they are compared only for voxels. */
static void assert_same_traces(const struct gl_pair *pair, const struct cone *cones, bool meshes)
{
    struct evidence many[CONES];
    struct evidence *out[CONES];
    const struct cone *in[CONES];
    for (int c = 0; c < CONES; c++) {
        assert_ok(evidence_init(&many[c], N));
        out[c] = &many[c];
        in[c] = &cones[c];
    }
    assert_ok(pair->gl->functions->trace_many(pair->gl, out, in, CONES));
    for (int c = 0; c < CONES; c++) {
        struct evidence alone;
        assert_ok(evidence_init(&alone, N));
        assert_ok(pair->rays->functions->trace(pair->rays, &alone, in[c]));
        if (!meshes || cone_is_wide(in[c])) {
            assert_same_evidence(&many[c], &alone);
        }
        evidence_finish(&alone);
        evidence_finish(&many[c]);
    }
}

static void assert_same_layers(const struct gl_pair *pair, const struct cone *cone)
{
    struct layers gl = gl_pair_pierce(pair->gl, cone);
    struct layers rays = gl_pair_pierce(pair->rays, cone);
    assert_int_equal(gl.count, rays.count);
    for (size_t s = 0; s < gl.count; s++) {
        assert_true(gl_pair_same_interval(&gl.intervals[s], &rays.intervals[s]));
    }
    layers_finish(&gl);
    layers_finish(&rays);
}

static void both_engines_say_the_same(void **state)
{
    (void)state;
    uint64_t random = 99;
    for (int i = 0; i < 12; i++) {
        bool meshes = i % 2;
        conus_atlas *atlas = meshes ? mesh_scene_atlas() : scene_atlas(&random, 20, 1);
        if (meshes) {
            mesh_scene_add_soups(atlas, &random);
            add(atlas, mesh_scene_torus(9, 4, 24, 12));
        }
        conus_sampling sampling = i % 6 == 2 ? CONUS_SAMPLING_SLICES : CONUS_SAMPLING_EXACT;
        struct gl_pair pair = gl_pair_create(atlas, sampling);
        struct cone cones[CONES];
        bool wanted[N * N];
        for (int c = 0; c < CONES; c++) {
            cones[c] = meshes ? mesh_scene_random_cone(&random, 12) : scene_cone(&random, atlas);
            cones[c].resolution = N;
            cones[c].angle = radians_from_degrees(c % 2 ? test_random(&random, 121, 179.9) : 40);
        }
        for (int p = 0; p < N * N; p++) {
            wanted[p] = cone_has_pixel(&cones[1], (uint32_t)p % N, (uint32_t)p / N);
        }
        cones[1].tracing.wanted = cones[3].tracing.wanted = wanted;
        assert_same_traces(&pair, cones, meshes);
        if (sampling == CONUS_SAMPLING_EXACT) {
            assert_same_layers(&pair, &cones[1]);
            assert_same_layers(&pair, &cones[5]);
        }
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
}

/* Outside of the aperture a wide cone's rays would point backwards: they are not traced. */
static void nothing_is_hit_outside_the_aperture(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add(atlas, mesh_scene_sphere((double[]){0, 0, 0}, 20, 20, 40));
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    const struct cone cone = mesh_scene_cone((double[]){0, 0, 0}, (double[]){1, 1, 0}, 178, 16);
    conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
    const conus_evidence evidence = conus_selection_evidence(selection);
    size_t count;
    const conus_interval *intervals = conus_selection_intervals(&count, selection);
    for (size_t pixel = 0; pixel < 256; pixel++) {
        assert_int_equal(evidence.object[pixel], evidence.in_cone[pixel]);
    }
    for (size_t s = 0; s < count; s++) {
        assert_true(evidence.in_cone[intervals[s].pixel]);
    }
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

enum { POSES = 12 };

/* The largest difference of a share between the two selectors. */
static double largest_difference(conus_selector *const selectors[2], size_t objects, const conus_pose *pose,
                                 double degrees)
{
    conus_selection *selections[2];
    double most = 0;
    for (int fine = 0; fine < 2; fine++) {
        assert_ok(conus_select(&selections[fine], selectors[fine], pose, degrees));
    }
    for (uint32_t object = 0; object <= objects; object++) {
        most = fmax(most, fabs(share_of(selections[0], object) - share_of(selections[1], object)));
    }
    conus_selection_destroy(selections[0]);
    conus_selection_destroy(selections[1]);
    return most;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Poses around AAL, from 60 to 140 mm away, at points in its middle. In perspective 208 pixels are off by up to 62
 * points at 179 degrees; now by as much as at 60 degrees, where it is usually 1 point and 2 to 3 at most. */
static void few_pixels_say_what_many_do(void **state)
{
    (void)state;
    static const uint32_t resolutions[2] = {16, 512};
    conus_selector *selectors[2];
    conus_atlas *atlas = NULL;
    conus_pose poses[POSES];
    uint64_t random = 17;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    for (int fine = 0; fine < 2; fine++) {
        const conus_selector_options options = {.resolution = resolutions[fine]};
        assert_ok(conus_selector_create(&selectors[fine], atlas, &options));
    }
    for (int p = 0; p < POSES; p++) {
        const double target[3] = {test_random(&random, -20, 20), test_random(&random, -40, 20),
                                  test_random(&random, -10, 30)};
        double away[3] = {test_random(&random, -1, 1), test_random(&random, -1, 1), test_random(&random, -1, 1)};
        vec3_scale(away, away, test_random(&random, 60, 140) / vec3_length(away));
        vec3_add_scaled(away, target, 1, away);
        assert_ok(conus_pose_toward(&poses[p], away, target, NULL));
    }
    assert_ok(conus_pose_toward(&poses[0], (double[]){-90, 20, 20}, (double[]){0, -10, 10}, NULL));
    static const double angles[] = {60, 121, 150, 165, 175, 179};
    for (size_t a = 0; a < sizeof angles / sizeof angles[0]; a++) {
        double worst[POSES];
        for (int p = 0; p < POSES; p++) {
            worst[p] = largest_difference(selectors, conus_atlas_object_count(atlas), &poses[p], angles[a]);
        }
        double first = worst[0];
        qsort(worst, POSES, sizeof *worst, ascending);
        print_message("%g degrees: %.2f points as a rule, %.2f at most\n", angles[a], 100 * worst[POSES / 2],
                      100 * worst[POSES - 1]);
        assert_true(first < 0.02);
        assert_true(worst[POSES / 2] < 0.02);
        assert_true(worst[POSES - 1] < 0.035);
    }
    conus_selector_destroy(selectors[0]);
    conus_selector_destroy(selectors[1]);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(wide)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_evenly_spread_in_angle),
        cmocka_unit_test(up_to_120_degrees_they_are_a_perspective_pictures),
        cmocka_unit_test(the_limit_is_where_a_pixel_on_the_axis_covers_three_times_the_mean),
        cmocka_unit_test(weights_sum_to_the_solid_angle),
        cmocka_unit_test(pixels_in_it_are_those_whose_rays_are),
        cmocka_unit_test(apertures_follow_the_angle),
        cmocka_unit_test(a_ball_has_its_solid_angle),
        cmocka_unit_test(a_ball_in_a_pyramid_too),
        cmocka_unit_test(volumes_and_scores_follow),
        cmocka_unit_test(a_range_cuts_at_planes),
        cmocka_unit_test(both_engines_say_the_same),
        cmocka_unit_test(nothing_is_hit_outside_the_aperture),
        cmocka_unit_test(few_pixels_say_what_many_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
