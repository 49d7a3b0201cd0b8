/* SPDX-License-Identifier: BSD-3-Clause */
/* Cameras of the window's 3-D pane: the orbit of the mouse, and the eye of a tracked head (Eq. 1). */
#include "viewer/pictures/pictures.h"

#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pane[2] = {640, 480};
static const double whole[4] = {0, 1, 0, 1};

static struct orbit make_orbit(uint64_t *seed)
{
    struct orbit orbit;
    orbit_look_at(&orbit, (double[]){1, 2, 3}, 90);
    orbit.azimuth = test_random(seed, -3, 3);
    orbit.elevation = test_random(seed, -1.5, 1.5);
    orbit_fit(&orbit, pane);
    return orbit;
}

/* A point along the ray through a pixel is drawn at that pixel. */
static void assert_rays_hit(const struct eye *sight, uint64_t *seed)
{
    const double *m = sight->camera.world_from_device;
    for (int i = 0; i < 20; i++) {
        double at[2] = {test_random(seed, 0, pane[0]), test_random(seed, 0, pane[1])};
        double direction[3], p[3], back[2];
        double t = test_random(seed, 1, 1000);
        eye_ray(direction, sight, pane, at);
        for (int a = 0; a < 3; a++) {
            p[a] = m[12 + a] + t * direction[a];
        }
        assert_true(eye_project(back, sight, pane, p));
        assert_near(back[0], at[0], 1e-6);
        assert_near(back[1], at[1], 1e-6);
        for (int a = 0; a < 3; a++) {
            p[a] = m[12 + a] - t * direction[a];
        }
        assert_false(eye_project(back, sight, pane, p));
    }
}

static struct head make_head(void)
{
    struct head head = {.on = true, .size = {400, 250}};
    assert_ok(conus_pose_along(&head.screen, (double[]){-120, 30, 5}, (double[]){1, 0.2, 0.1}, NULL));
    return head;
}

/* A place in front of the screen: at a part of its width and height, and so many mm before it. */
static void place_on(double out[3], const struct head *head, double right, double up, double before)
{
    const double *m = head->screen.world_from_device;
    for (int a = 0; a < 3; a++) {
        out[a] = m[12 + a] + (right - 0.5) * head->size[0] * m[a] + (up - 0.5) * head->size[1] * m[4 + a] +
                 before * m[8 + a];
    }
}

static void the_mouse_hits_the_drawn_point(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int round = 0; round < 100; round++) {
        struct orbit orbit = make_orbit(&seed);
        struct head head = make_head();
        struct eye sight;
        double eye[3];
        eye_of_orbit(&sight, &orbit, pane);
        assert_near(sight.frustum[1], -sight.frustum[0], 0);
        assert_near(sight.frustum[3], tan(orbit.field_of_view / 2), 0);
        assert_rays_hit(&sight, &seed);
        place_on(eye, &head, test_random(&seed, -2, 3), test_random(&seed, -2, 3), test_random(&seed, 100, 900));
        head_move(&head, eye, &head.screen);
        assert_true(head_eye(&sight, &head, whole));
        assert_rays_hit(&sight, &seed);
    }
}

/* A point of the screen is drawn at its own pixel, whichever part of the screen the pane is and wherever the eye is. */
static void the_pane_is_its_part_of_the_screen(void **state)
{
    (void)state;
    uint64_t seed = 6;
    const double parts[][4] = {{0, 1, 0, 1}, {0.2, 0.45, 0.5, 1}, {-0.1, 0.3, -0.2, 0.1}};
    for (int round = 0; round < 300; round++) {
        const double *part = parts[round % 3];
        struct head head = make_head();
        struct eye sight;
        double eye[3], place[3], at[2];
        double right = test_random(&seed, -0.5, 1.5);
        double up = test_random(&seed, -0.5, 1.5);
        place_on(eye, &head, test_random(&seed, -2, 3), test_random(&seed, -2, 3), test_random(&seed, 100, 900));
        place_on(place, &head, right, up, 0);
        head_move(&head, eye, &head.screen);
        assert_true(head_eye(&sight, &head, part));
        assert_true(eye_project(at, &sight, pane, place));
        assert_near(at[0], pane[0] * (right - part[0]) / (part[1] - part[0]), 1e-6);
        assert_near(at[1], pane[1] * (part[3] - up) / (part[3] - part[2]), 1e-6);
    }
}

/* An eye that is not before the screen gives no view: the last one is kept, and a text says so. */
static void the_last_view_is_kept(void **state)
{
    (void)state;
    struct head head = make_head();
    struct eye sight, kept;
    double eye[3], bad[3];
    bool is_well;
    assert_false(head_eye(&sight, &head, whole));
    assert_non_null(strstr(head_text(&head, &is_well), "no tracker"));
    place_on(eye, &head, 0.2, 0.9, 500);
    head_set_state(&head, STATION_SEEN);
    head_move(&head, eye, &head.screen);
    assert_true(head_eye(&kept, &head, whole));
    assert_string_equal(head_text(&head, &is_well), "as the head sees it");
    assert_true(is_well);
    const double offs[] = {0, -10, -1e9, NAN, INFINITY};
    for (size_t i = 0; i < sizeof offs / sizeof *offs; i++) {
        unsigned number = head.number;
        head.inside = false;
        place_on(bad, &head, 0.5, 0.5, offs[i]);
        head_move(&head, bad, &head.screen);
        assert_true(head_eye(&sight, &head, whole));
        assert_memory_equal(&sight, &kept, sizeof sight);
        assert_non_null(strstr(head_text(&head, &is_well), "not before the screen"));
        assert_false(is_well);
        assert_true(head.number != number);
    }
    head_move(&head, eye, &head.screen);
    for (int s = STATION_WAITING; s < STATION_SEEN; s++) {
        head_set_state(&head, (enum station_state)s);
        assert_non_null(strstr(head_text(&head, &is_well), "last view kept"));
        assert_false(is_well);
        assert_true(head_eye(&sight, &head, whole));
    }
    assert_true(head_toggle(&head));
    assert_null(head_text(&head, &is_well));
    assert_false(head_eye(&sight, &head, whole));
    head = (struct head){0};
    assert_false(head_toggle(&head)); /* there is none */
    assert_false(head.on);
}

/* Panning moves the point in the middle with the mouse, pixel by pixel, and does not turn the view. */
static void panning_moves_the_middle_with_the_mouse(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int round = 0; round < 50; round++) {
        struct orbit orbit = make_orbit(&seed);
        const struct orbit before = orbit;
        const double moved[2] = {test_random(&seed, -200, 200), test_random(&seed, -200, 200)};
        struct eye sight;
        double at[2];
        orbit_pan(&orbit, moved[0], moved[1], pane[1]);
        eye_of_orbit(&sight, &orbit, pane);
        assert_true(eye_project(at, &sight, pane, before.centre));
        assert_near(at[0], pane[0] / 2 + moved[0], 1e-6);
        assert_near(at[1], pane[1] / 2 + moved[1], 1e-6);
        assert_true(orbit.azimuth == before.azimuth && orbit.elevation == before.elevation);
    }
}

/* The view turns by 3.5 radians for a pane's height; points nearer than the middle go down with the mouse. */
static void the_view_turns_about_the_middle(void **state)
{
    (void)state;
    for (int way = 0; way < 4; way++) {
        static const double moves[4][2] = {{8, 0}, {-8, 0}, {0, 8}, {0, -8}};
        struct orbit orbit;
        conus_pose before, after;
        struct eye sight;
        double at[2], near[3], turned = 0;
        orbit_look_at(&orbit, (double[]){1, 2, 3}, 90);
        orbit.elevation = 0; /* where both ways turn by the angle itself */
        orbit_camera(&before, &orbit);
        for (int a = 0; a < 3; a++) {
            near[a] = orbit.centre[a] + 20 * before.world_from_device[8 + a];
        }
        orbit_turn(&orbit, moves[way][0], moves[way][1], pane[1]);
        orbit_camera(&after, &orbit);
        eye_of_orbit(&sight, &orbit, pane);
        assert_true(eye_project(at, &sight, pane, near));
        for (int a = 0; a < 3; a++) {
            turned += before.world_from_device[8 + a] * after.world_from_device[8 + a];
            assert_near(after.world_from_device[12 + a],
                        orbit.centre[a] + orbit.distance * after.world_from_device[8 + a], 1e-9);
        }
        assert_near(acos(turned), 3.5 * 8 / pane[1], 1e-9);
        assert_int_equal(fabs(at[0] - pane[0] / 2) > 0.1, moves[way][0] != 0);
        assert_int_equal(at[1] - pane[1] / 2 > 0.1, moves[way][1] > 0);
        assert_int_equal(at[1] - pane[1] / 2 < -0.1, moves[way][1] < 0);
    }
}

/* A click of the wheel leaves 9 tenths of the distance, which is limited to 1 mm and 100 m. */
static void the_wheel_comes_nearer(void **state)
{
    (void)state;
    struct orbit orbit;
    orbit_look_at(&orbit, (double[]){1, 2, 3}, 90);
    const double before = orbit.distance;
    orbit_zoom(&orbit, 2);
    assert_near(orbit.distance, 0.81 * before, 1e-9);
    orbit_zoom(&orbit, -2);
    assert_near(orbit.distance, before, 1e-9);
    orbit_zoom(&orbit, 1e4);
    assert_near(orbit.distance, 1, 0);
    orbit_zoom(&orbit, -1e4);
    assert_near(orbit.distance, 1e5, 0);
}

TEST_GROUP(sight)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mouse_hits_the_drawn_point),  cmocka_unit_test(the_pane_is_its_part_of_the_screen),
        cmocka_unit_test(the_last_view_is_kept),           cmocka_unit_test(panning_moves_the_middle_with_the_mouse),
        cmocka_unit_test(the_view_turns_about_the_middle), cmocka_unit_test(the_wheel_comes_nearer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
