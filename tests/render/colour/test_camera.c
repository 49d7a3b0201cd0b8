/* SPDX-License-Identifier: BSD-3-Clause */
/* Cameras frame points and project them. */
#include "base/geometry/math3.h"
#include "render/gl/camera.h"
#include "test.h"

static void assert_rigid(const double m[16])
{
    for (ptrdiff_t a = 0; a < 3; a++) {
        for (ptrdiff_t b = 0; b < 3; b++) {
            assert_near(vec3_dot(m + 4 * a, m + 4 * b), a == b, 1e-12);
        }
    }
    assert_near(mat4_determinant3(m), 1, 1e-12);
}

/* All points lie in the free part, and some touch two opposite edges of it, so that no nearer camera would do. */
static void points_fill_the_free_part(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int round = 0; round < 200; round++) {
        double points[40][3], forward[3];
        for (int i = 0; i < 40; i++) {
            for (int a = 0; a < 3; a++) {
                points[i][a] = test_random(&seed, -80, 90) + (a == 1 ? 1000 : 0);
            }
        }
        for (int a = 0; a < 3; a++) {
            forward[a] = test_random(&seed, -1, 1);
        }
        const struct camera_frame frame = {1400, 1050, (uint32_t)test_random(&seed, 0, 600), 50, 40, 200};
        struct camera camera;
        camera_frame_points(&camera, points[0], 40, forward, test_random(&seed, 0.2, 1.5), &frame);
        assert_rigid(camera.world_from_camera);
        double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
        for (int i = 0; i < 40; i++) {
            double x, y, depth;
            assert_true(camera_project(&x, &y, &depth, &camera, &frame, points[i]));
            left = fmin(left, x);
            right = fmax(right, x);
            top = fmin(top, y);
            bottom = fmax(bottom, y);
        }
        double x_slack = fmax(left - frame.left, frame.width - frame.right - right);
        double y_slack = fmax(top - frame.top, frame.height - frame.bottom - bottom);
        assert_true(left > frame.left - 1e-6 && right < frame.width - frame.right + 1e-6);
        assert_true(top > frame.top - 1e-6 && bottom < frame.height - frame.bottom + 1e-6);
        assert_near(fmin(x_slack, y_slack), 0, 1e-6);
    }
}

static void superior_is_up(void **state)
{
    (void)state;
    const struct camera_frame frame = {.width = 100, .height = 100};
    const double points[2][3] = {{-50, -50, -50}, {50, 50, 50}};
    double forward[3];
    camera_default_forward(forward);
    struct camera camera;
    camera_frame_points(&camera, points[0], 2, forward, 0.5, &frame);
    double x, y, depth, other, above;
    assert_true(camera_project(&x, &y, &depth, &camera, &frame, (double[]){0, 0, 0}));
    assert_true(camera_project(&other, &above, &depth, &camera, &frame, (double[]){0, 0, 10}));
    assert_near(camera.world_from_camera[2], 0, 1e-12); /* its x axis is level */
    assert_true(above < y);
    camera_frame_points(&camera, points[0], 2, (double[]){0, 0, -1}, 0.5, &frame); /* from above: anterior up */
    static const double wanted[9] = {1, 0, 0, 0, 0, 1, 0, 0, 0};                   /* and the right on the right */
    for (int i = 0; i < 8; i++) {
        assert_near(camera.world_from_camera[i], wanted[i], 1e-12);
    }
}

/* A cone is seen from about 35 degrees off its axis, from behind it, wherever it comes from. */
static void cones_are_seen_from_their_side(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int round = 0; round < 1000; round++) {
        double axis[3], forward[3];
        for (int a = 0; a < 3; a++) {
            axis[a] = round < 6 ? (round % 3 == a) * (round < 3 ? 1 : -1) : test_random(&seed, -1, 1);
        }
        camera_cone_forward(forward, axis);
        double cosine = vec3_dot(axis, forward) / vec3_length(axis) / vec3_length(forward);
        assert_true(cosine > cos(radians_from_degrees(60)));
        assert_true(cosine < cos(radians_from_degrees(20)));
    }
}

static void what_is_behind_is_not_projected(void **state)
{
    (void)state;
    conus_pose pose;
    mat4_identity(pose.world_from_device);
    struct camera camera;
    camera_from_pose(&camera, &pose, radians_from_degrees(90), 200, 100);
    const struct camera_frame frame = {.width = 200, .height = 100};
    double x, y, depth;
    assert_false(camera_project(&x, &y, &depth, &camera, &frame, (double[]){0, 0, 1}));
    assert_true(camera_project(&x, &y, &depth, &camera, &frame, (double[]){10, 5, -10}));
    assert_near(x, 150, 1e-9);
    assert_near(y, 25, 1e-9);
    assert_near(depth, 10, 1e-12);
}

TEST_GROUP(camera)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_fill_the_free_part),
        cmocka_unit_test(superior_is_up),
        cmocka_unit_test(cones_are_seen_from_their_side),
        cmocka_unit_test(what_is_behind_is_not_projected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
