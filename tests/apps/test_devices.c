/* SPDX-License-Identifier: BSD-3-Clause */
/* A SpaceMouse behind a fake spacenavd and a fake gamepad, as sources and moving a tool. */
#include "viewer/devices/devices.h"
#include "viewer/tools/tools.h"

#include "test.h"
#include "window_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static struct gamepad_reading reading; /* the state of the fake gamepad */

static void read_fake(struct gamepad_reading *out)
{
    *out = reading;
}

static struct source_update ask(struct source *source, double now_s)
{
    struct source_update update;
    source_ask(source, now_s, &update);
    return update;
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The dead zone is 0.15 of a stick, and 0.05 of a trigger: a stick that is pushed s far moves by (s - 0.15) / 0.85 of
 * 40 mm/s, here for 20 ms. */
static void sticks_move_and_turn(void **state)
{
    struct gamepad gamepad;
    (void)state;
    gamepad_init(&gamepad, read_fake);
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .left = {0.1, -0.1}, .triggers = {0.04, 0.05}};
    ask(&gamepad.source, 1);
    struct source_update update = ask(&gamepad.source, 1.02);
    assert_int_equal(update.state, SOURCE_WELL);
    assert_near(length(update.move) + length(update.turn) + update.widen, 0, 0); /* nobody touches it */
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .left = {0.3, -0.4}};
    update = ask(&gamepad.source, 1.04);
    double way = 40 * 0.02 * (0.5 - 0.15) / 0.85;
    assert_near(update.move[0], way * 0.6, 1e-9);
    assert_near(update.move[1], 0, 0);
    assert_near(update.move[2], -way * 0.8, 1e-9); /* the stick points away: forward is -z */
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .right = {-1, 0}, .up = true};
    update = ask(&gamepad.source, 1.06);
    assert_near(update.turn[1], 40 * 0.02 * M_PI / 180, 1e-9); /* to the left: about +y */
    assert_near(update.move[1], 0.8, 1e-9);
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .right = {0, -1}};
    assert_near(ask(&gamepad.source, 1.08).turn[0], 40 * 0.02 * M_PI / 180, 1e-9); /* up: about +x */
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .triggers = {0, 1}};
    assert_near(ask(&gamepad.source, 1.1).widen, exp2(0.02), 1e-9);
    reading.triggers[0] = 1;
    assert_near(ask(&gamepad.source, 1.12).widen, 0, 0); /* one against the other */
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .left = {1, 0}};
    assert_near(ask(&gamepad.source, 9).move[0], 40 * 0.05, 1e-9); /* a window that slept does not jump */
}

static void buttons_are_pressed_once(void **state)
{
    struct gamepad gamepad;
    (void)state;
    gamepad_init(&gamepad, read_fake);
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .pressed = SOURCE_HOLD};
    assert_int_equal(ask(&gamepad.source, 1).pressed, SOURCE_HOLD);
    assert_int_equal(ask(&gamepad.source, 2).pressed, 0);
    reading.pressed = SOURCE_HOLD | SOURCE_RESET;
    assert_int_equal(ask(&gamepad.source, 3).pressed, SOURCE_RESET);
    reading.pressed = 0;
    assert_int_equal(ask(&gamepad.source, 4).pressed, 0);
    reading.pressed = SOURCE_HOLD;
    assert_int_equal(ask(&gamepad.source, 5).pressed, SOURCE_HOLD);
}

static void what_is_wrong_with_a_gamepad_is_said(void **state)
{
    struct gamepad gamepad;
    (void)state;
    gamepad_init(&gamepad, read_fake);
    reading = (struct gamepad_reading){.presence = GAMEPAD_NONE};
    assert_non_null(strstr(ask(&gamepad.source, 1).text, "no gamepad is plugged in"));
    reading.presence = GAMEPAD_UNKNOWN;
    assert_non_null(strstr(ask(&gamepad.source, 1).text, "unknown layout"));
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .left = {1, 0}};
    struct source_update update = ask(&gamepad.source, 2);
    assert_null(update.text);
    for (int i = 0; i < 5; i++) { /* a stick that is stuck, at 2 to 7 s */
        assert_int_equal(ask(&gamepad.source, 2.5 + i).state, SOURCE_WELL);
    }
    update = ask(&gamepad.source, 7);
    assert_int_equal(update.state, SOURCE_FROZEN);
    assert_near(length(update.move), 0, 0);
    reading.left[0] = 0.9;
    assert_int_equal(ask(&gamepad.source, 7.1).state, SOURCE_WELL);
    reading.left[0] = NAN;
    update = ask(&gamepad.source, 7.2);
    assert_int_equal(update.state, SOURCE_BROKEN);
    assert_near(length(update.move), 0, 0);
    reading = (struct gamepad_reading){.presence = GAMEPAD_NONE};
    update = ask(&gamepad.source, 7.3);
    assert_int_equal(update.state, SOURCE_ABSENT);
    assert_non_null(strstr(update.text, "unplugged"));
}

static void open_window(struct window *out, struct viewer *viewer)
{
    window_scene_open(out, viewer);
    devices_init(&out->inputs.devices);
    gamepad_init(&out->inputs.devices.gamepad, read_fake);
}

static void close_window(struct window *window)
{
    spacemouse_finish(&window->inputs.devices.spacemouse);
    viewer_finish(window->viewer);
}

static void a_gamepad_moves_the_first_tool(void **state)
{
    struct viewer viewer;
    struct window window;
    struct notice notice;
    (void)state;
    open_window(&window, &viewer);
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE};
    assert_true(isinf(inputs_idle_s(&window.inputs, window.viewer))); /* a device that nobody chose is not polled */
    tool_choose(window.viewer, FIRST_TOOL, POINT_BY_GAMEPAD);
    inputs_step(&window.inputs, window.viewer, 1);
    assert_near(inputs_idle_s(&window.inputs, window.viewer), 0.02, 1e-12);
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    inputs_notice(&notice, &window.inputs, window.viewer, FIRST_TOOL);
    assert_non_null(strstr(notice.text, "move it"));
    reading.left[1] = -1;
    inputs_step(&window.inputs, window.viewer, 1.01); /* puts it there */
    assert_true(viewer.tools[FIRST_TOOL].has_pose);
    double y = viewer.tools[FIRST_TOOL].pose.world_from_device[13];
    inputs_step(&window.inputs, window.viewer, 1.03);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], y - 0.8, 1e-9); /* it looks along -y */
    assert_int_equal(conus_selection_result(viewer_selection(&viewer), 0)->object, 1);
    devices_set_speed(&window.inputs.devices, 100);
    inputs_step(&window.inputs, window.viewer, 1.05);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], y - 2.8, 1e-9);
    reading.pressed = SOURCE_HOLD;
    inputs_step(&window.inputs, window.viewer, 1.07); /* the move comes before the button */
    assert_true(viewer.tools[FIRST_TOOL].held);
    inputs_step(&window.inputs, window.viewer, 1.09);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], y - 4.8, 1e-9);
    inputs_notice(&notice, &window.inputs, window.viewer, FIRST_TOOL);
    assert_non_null(strstr(notice.text, "held"));
    reading.pressed = SOURCE_RESET;
    inputs_step(&window.inputs, window.viewer, 1.11);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], y, 1e-9);
    reading = (struct gamepad_reading){.presence = GAMEPAD_THERE, .triggers = {1, 0}};
    inputs_step(&window.inputs, window.viewer, 1.13);
    assert_near(viewer.tools[FIRST_TOOL].angle, 5 * exp2(-0.02), 1e-9);
    reading = (struct gamepad_reading){.presence = GAMEPAD_NONE};
    inputs_step(&window.inputs, window.viewer, 1.15);
    inputs_notice(&notice, &window.inputs, window.viewer, FIRST_TOOL);
    assert_true(notice.is_trouble && !notice.is_old); /* its answer is that of its pose still */
    assert_non_null(strstr(notice.text, "unplugged"));
    assert_near(inputs_idle_s(&window.inputs, window.viewer), 0.5, 1e-12);
    close_window(&window);
}

#ifdef CONUS_SPACEMOUSE

#include <spnav.h>

enum { MOTION = 0, PRESS = 1, RELEASE = 2, DEVICE = 3, PATH_SIZE = 108 };

/* Stands for spacenavd: it listens, and never answers a request, as the oldest versions do. */
struct daemon {
    int listener, peer;
    char path[PATH_SIZE];
};

static void start_daemon(struct daemon *out)
{
    struct sockaddr_un place = {.sun_family = AF_UNIX};
    char folder[] = "/tmp/conus-spnav-XXXXXX"; /* a socket's path is short */
    assert_non_null(mkdtemp(folder));
    snprintf(out->path, sizeof out->path, "%s/sock", folder);
    snprintf(place.sun_path, sizeof place.sun_path, "%s", out->path);
    setenv("SPNAV_SOCKET", out->path, 1);
    out->listener = socket(AF_UNIX, SOCK_STREAM, 0);
    assert_int_equal(bind(out->listener, (const struct sockaddr *)&place, sizeof place), 0);
    assert_int_equal(listen(out->listener, 4), 0);
    out->peer = -1;
}

/* Accepts two connections: the first only tested whether spacenavd answers. */
static void welcome(struct daemon *daemon)
{
    close(accept(daemon->listener, NULL, NULL));
    daemon->peer = accept(daemon->listener, NULL, NULL);
    assert_true(daemon->peer >= 0);
}

static void stop_daemon(struct daemon *daemon)
{
    char folder[PATH_SIZE];
    close(daemon->peer);
    close(daemon->listener);
    unlink(daemon->path);
    snprintf(folder, sizeof folder, "%s", daemon->path);
    *strrchr(folder, '/') = '\0';
    rmdir(folder);
}

static void say(const struct daemon *daemon, int type, const int values[7])
{
    int32_t data[8] = {type};
    for (int i = 0; i < 7; i++) {
        data[1 + i] = values[i];
    }
    assert_int_equal(send(daemon->peer, data, sizeof data, MSG_NOSIGNAL), sizeof data);
}

/* libspnav's own function for moving an object gives the directions; it moves by a thousandth a unit. The amounts are
 * 40 mm/s and 40 degrees/s for 350 units. */
static void check_move(struct spacemouse *mouse, const struct daemon *daemon, const int axes[6], double now_s)
{
    const struct spnav_event_motion motion = {
        .x = axes[0], .y = axes[1], .z = axes[2], .rx = axes[3], .ry = axes[4], .rz = axes[5]};
    struct spnav_posrot wanted;
    const int values[7] = {axes[0], axes[1], axes[2], axes[3], axes[4], axes[5], 10};
    ask(&mouse->source, now_s);
    say(daemon, MOTION, values);
    struct source_update update = ask(&mouse->source, now_s + 0.01);
    assert_int_equal(update.state, SOURCE_WELL);
    assert_null(update.text);
    spnav_posrot_init(&wanted);
    spnav_posrot_moveobj(&wanted, &motion);
    double angle = 2 * acos(fmin((double)wanted.rot[3], 1));
    for (int a = 0; a < 3; a++) {
        double part = angle > 0 ? (double)wanted.rot[a] / sin(angle / 2) : 0; /* of the axis */
        double units = sqrt((double)(axes[3] * axes[3] + axes[4] * axes[4] + axes[5] * axes[5]));
        assert_near(update.move[a], 0.4 / 350 * 1000 * (double)wanted.pos[a], 1e-6);
        assert_near(update.turn[a], 0.4 / 350 * units * M_PI / 180 * part, 1e-5);
    }
    say(daemon, MOTION, (const int[7]){0});
    update = ask(&mouse->source, now_s + 0.02);
    assert_near(length(update.move) + length(update.turn), 0, 0); /* it was let go */
}

static void a_cap_moves_and_turns(void **state)
{
    struct daemon daemon;
    struct spacemouse mouse;
    (void)state;
    spacemouse_init(&mouse);
    setenv("SPNAV_SOCKET", "/nowhere/there", 1);
    struct source_update update = ask(&mouse.source, 1);
    if (update.state != SOURCE_ABSENT) {
        skip(); /* a spacenavd of this machine */
    }
    assert_non_null(strstr(update.text, "no spacenavd answers"));
    start_daemon(&daemon);
    assert_int_equal(ask(&mouse.source, 2).state, SOURCE_ABSENT); /* it looks again after 2 s */
    update = ask(&mouse.source, 3);
    assert_int_equal(update.state, SOURCE_SILENT);
    assert_non_null(strstr(update.text, "move the SpaceMouse's cap"));
    welcome(&daemon);
    for (int i = 0; i < 6; i++) {
        int axes[6] = {0};
        axes[i] = 350;
        check_move(&mouse, &daemon, axes, 4 + i);
        axes[i] = -100;
        check_move(&mouse, &daemon, axes, 4.5 + i);
    }
    say(&daemon, MOTION, (const int[7]){350, 0, 0, 0, 0, 0, 10});
    ask(&mouse.source, 20);
    assert_true(length(ask(&mouse.source, 20.2).move) > 0);
    assert_near(length(ask(&mouse.source, 20.3).move), 0, 0); /* nothing more came: it does not drive on */
    say(&daemon, PRESS, (const int[7]){0});
    say(&daemon, RELEASE, (const int[7]){0});
    say(&daemon, PRESS, (const int[7]){1});
    assert_int_equal(ask(&mouse.source, 21).pressed, SOURCE_HOLD | SOURCE_RESET);
    say(&daemon, PRESS, (const int[7]){29});
    assert_int_equal(ask(&mouse.source, 21).pressed, 0);
    say(&daemon, DEVICE, (const int[7]){SPNAV_DEV_RM});
    update = ask(&mouse.source, 22);
    assert_int_equal(update.state, SOURCE_ABSENT);
    assert_non_null(strstr(update.text, "unplugged"));
    say(&daemon, DEVICE, (const int[7]){SPNAV_DEV_ADD});
    assert_int_equal(ask(&mouse.source, 23).state, SOURCE_WELL);
    stop_daemon(&daemon);
    update = ask(&mouse.source, 24);
    assert_int_equal(update.state, SOURCE_ABSENT);
    assert_non_null(strstr(update.text, "no spacenavd answers"));
    spacemouse_finish(&mouse);
}

/* A device that keeps sending the same motion is stuck; after 5 s it moves nothing any more. */
static void a_spacemouse_moves_the_second_tool(void **state)
{
    struct daemon daemon;
    struct viewer viewer;
    struct window window;
    struct notice notice;
    (void)state;
    start_daemon(&daemon);
    open_window(&window, &viewer);
    tool_use_second(&viewer, true);
    tool_choose(window.viewer, SECOND_TOOL, POINT_BY_SPACEMOUSE);
    inputs_step(&window.inputs, window.viewer, 1);
    if (window.inputs.devices.received[SECOND_TOOL].state != SOURCE_SILENT) {
        skip();
    }
    welcome(&daemon);
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_non_null(strstr(notice.text, "move the SpaceMouse's cap"));
    const int away[7] = {0, 0, 350, 0, 0, 0, 10};
    say(&daemon, MOTION, away);
    inputs_step(&window.inputs, window.viewer, 1.01);
    double x = window.viewer->tools[SECOND_TOOL].pose.world_from_device[12]; /* to the right, looking left */
    for (int i = 1; i <= 60; i++) {
        say(&daemon, MOTION, away);
        inputs_step(&window.inputs, window.viewer, 1.01 + 0.1 * i);
    }
    double moved = x - window.viewer->tools[SECOND_TOOL].pose.world_from_device[12];
    assert_near(moved, 49 * 40 * 0.05, 2.1); /* 50 ms at most count of each 100; up to 5 s after it began */
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_true(notice.is_trouble);
    assert_non_null(strstr(notice.text, "frozen"));
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    say(&daemon, PRESS, (const int[7]){1});
    inputs_step(&window.inputs, window.viewer, 8);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[12], x, 1e-9);
    stop_daemon(&daemon);
    close_window(&window);
}

#endif

TEST_GROUP(devices)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sticks_move_and_turn),
        cmocka_unit_test(buttons_are_pressed_once),
        cmocka_unit_test(what_is_wrong_with_a_gamepad_is_said),
        cmocka_unit_test(a_gamepad_moves_the_first_tool),
#ifdef CONUS_SPACEMOUSE
        cmocka_unit_test(a_cap_moves_and_turns),
        cmocka_unit_test(a_spacemouse_moves_the_second_tool),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
