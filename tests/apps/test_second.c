/* SPDX-License-Identifier: BSD-3-Clause */
/* The second tool without a window: its answers, the devices that move it, holding it, its cone's lines, sessions. */
#include "options/progress.h"
#include "viewer/commands/commands.h"
#include "viewer/session/session.h"
#include "viewer/tools/tools.h"

#include "session_words.h"
#include "test.h"
#include "window_scene.h"

#include <arpa/inet.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static const double eye[3] = {0, 90, 0};
static const double back[3] = {0, -1, 0};

static void open_window(struct window *out, struct viewer *viewer)
{
    window_scene_open(out, viewer);
    devices_init(&out->inputs.devices);
    undo_note(out);
}

static void close_window(struct window *window)
{
    changes_finish(&window->history.changes);
    free(window->history.session_path);
    viewer_finish(window->viewer);
}

static void aim(struct window *window, const double origin[3], const double direction[3])
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, origin, direction, NULL));
    tool_aim(window->viewer, SECOND_TOOL, &pose);
}

/* Compares the second tool's answer with that of another selector, which knows nothing of the first tool. */
static void check_answer(struct window *window)
{
    conus_selector *selector = NULL;
    conus_selection *wanted = NULL;
    const struct tool *second = &window->viewer->tools[SECOND_TOOL];
    tool_update_second(window->viewer);
    assert_ok(conus_selector_create(&selector, window->viewer->drawn->atlas, &window->viewer->cone.options));
    assert_ok(conus_select(&wanted, selector, &second->pose, second->angle));
    const conus_selection *got = view_atlas_selection(window->viewer->atlases, SECOND_TOOL);
    assert_int_equal(conus_selection_count(got), conus_selection_count(wanted));
    for (size_t i = 0; i < conus_selection_count(wanted); i++) {
        const conus_result *a = conus_selection_result(got, i);
        const conus_result *b = conus_selection_result(wanted, i);
        assert_int_equal(a->object, b->object);
        assert_int_equal(a->pixels, b->pixels);
        assert_true(a->share == b->share);
    }
    conus_selection_destroy(wanted);
    conus_selector_destroy(selector);
}

static void each_tool_has_answers_of_its_own(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    aim(&window, (double[]){70, 5, 3}, (double[]){-1, 0, 0});
    tool_update_second(&viewer);
    assert_null(view_atlas_selection(&viewer.atlases[0], SECOND_TOOL)); /* it is off */
    tool_use_second(&viewer, true);
    window.viewer->tools[SECOND_TOOL].angle = 40;
    tool_changed(window.viewer, SECOND_TOOL);
    check_answer(&window);
    assert_near(viewer.tools[FIRST_TOOL].angle, 5, 0);
    unsigned number = window.viewer->tools[SECOND_TOOL].answer_number;
    tool_update_second(&viewer);
    assert_int_equal(window.viewer->tools[SECOND_TOOL].answer_number, number); /* nothing to ask */
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    viewer.cone.options.resolution = 24;
    tool_reselect(&viewer);
    check_answer(&window);
    viewer_hide(&viewer, 1, true);
    check_answer(&window);
    assert_int_equal(conus_selection_result(view_atlas_selection(&viewer.atlases[0], SECOND_TOOL), 0)->object, 2);
    tool_use_second(&viewer, false);
    assert_null(view_atlas_selection(&viewer.atlases[0], SECOND_TOOL));
    assert_non_null(viewer_selection(&viewer));
    close_window(&window);
}

static void its_table_is_that_of_its_answers(void **state)
{
    struct viewer viewer;
    struct window window;
    char path[512];
    char got[4096] = "";
    (void)state;
    open_window(&window, &viewer);
    snprintf(path, sizeof path, "%s", test_scratch("second.tsv"));
    char *const words[] = {"second", "results", path};
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 90, 0}, (double[]){0, 1, 0}); /* the first hits nothing */
    aim(&window, eye, back);
    tool_use_second(&viewer, true);
    assert_true(script_do(&window, words, 3));
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t size = fread(got, 1, sizeof got - 1, file);
    fclose(file);
    assert_true(size > 0);
    assert_non_null(strstr(got, "Shell outer"));
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    char *first = viewer_results_text(&viewer); /* of the same pose and angle */
    assert_string_equal(got, first);
    free(first);
    close_window(&window);
}

/* The first tool's shape, a cylinder or a single ray, is the second tool's, too; each has its own angle. */
static void shapes_are_shared(void **state)
{
    struct viewer viewer;
    struct window window;
    conus_selector_options options;
    (void)state;
    open_window(&window, &viewer);
    window.viewer->tools[SECOND_TOOL].angle = 30;
    assert_near(viewer_query(&options, &viewer, SECOND_TOOL, 0), 30, 0);
    viewer.cone.options.radius = 3;
    assert_near(viewer_query(&options, &viewer, SECOND_TOOL, 0), 0, 0);
    viewer.cone.one_ray = true;
    assert_true(viewer_query(&options, &viewer, SECOND_TOOL, 0) < 0.5);
    assert_int_equal(options.resolution, 1);
    close_window(&window);
}

static void a_device_moves_one_tool(void **state)
{
    struct viewer viewer;
    struct window window;
    struct notice notice;
    (void)state;
    open_window(&window, &viewer);
    tool_use_second(&viewer, true);
    assert_int_equal(window.viewer->tools[SECOND_TOOL].pointer, POINT_BY_WAND); /* the first has the mouse */
    tool_choose(window.viewer, SECOND_TOOL, POINT_BY_MOUSE);
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_true(notice.is_trouble);
    assert_int_equal(tool_moved_by(&viewer, POINT_BY_MOUSE), FIRST_TOOL);
    tool_choose(window.viewer, FIRST_TOOL, POINT_BY_WAND);
    assert_int_equal(tool_moved_by(&viewer, POINT_BY_MOUSE), SECOND_TOOL);
    const double before = point_before(&viewer);
    inputs_point(&window.inputs, window.viewer, eye, back);
    unsigned version = viewer.tools[SECOND_TOOL].version;
    inputs_point(&window.inputs, window.viewer, eye, back); /* a pose that stays is no move */
    assert_int_equal(viewer.tools[SECOND_TOOL].version, version);
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 24 + before,
                1); /* before the outermost ball */
    assert_int_equal(conus_selection_result(view_atlas_selection(&viewer.atlases[0], SECOND_TOOL), 0)->object, 1);
    tool_hold(&viewer, SECOND_TOOL);
    inputs_point(&window.inputs, window.viewer, (double[]){0, -90, 0}, (double[]){0, 1, 0});
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 24 + before, 1);
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_non_null(strstr(notice.text, "held"));
    tool_hold(&viewer, SECOND_TOOL);
    inputs_point(&window.inputs, window.viewer, (double[]){0, -90, 0}, (double[]){0, 1, 0});
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], -24 - before, 1);
    tool_confirm(&viewer, SECOND_TOOL);
    assert_int_equal(viewer.pin_count, 1);
    assert_int_equal(viewer.pins[0].object, 1);
    close_window(&window);
}

static int connect_to(struct station *station)
{
    const struct sockaddr_in place = {
        .sin_family = AF_INET, .sin_port = htons(station_port(station)), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int peer = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(connect(peer, (const struct sockaddr *)&place, sizeof place), 0);
    return peer;
}

static void send_pose(int peer, const char *tool, double y)
{
    const double matrix[16] = {-1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, y, 0, 1}; /* looks along -y */
    uint8_t bytes[4096];
    size_t size = igtl_write_transform(bytes, sizeof bytes, tool, 2, matrix);
    assert_int_equal(send(peer, bytes, size, MSG_NOSIGNAL), size);
}

static void step(struct window *window)
{
    usleep(2000);
    inputs_step(&window->inputs, window->viewer, 0);
}

/* Waits until the second tool is in that state; a test that hangs is ended from outside. */
static void step_until(struct window *window, enum station_state wanted)
{
    do {
        step(window);
    } while (window->inputs.devices.trackers[SECOND_TOOL].tool.state != wanted);
}

/* Sends the pose until it has arrived and is seen: on a busy machine half a second may pass in between. */
static void send_until_seen(struct window *window, int peer, const char *name, double y)
{
    const struct station_tool *tool = &window->inputs.devices.trackers[SECOND_TOOL].tool;
    do {
        send_pose(peer, name, y);
        step(window);
    } while (tool->state != STATION_SEEN || fabs(tool->pose.world_from_device[13] - y) > 1e-5);
}

static struct station *start(const char *tool, const char *second)
{
    struct station *station = NULL;
    char why[200];
    assert_true(station_start(&station, &(struct station_options){.tool = tool, .second = second}, why, sizeof why));
    return station;
}

static void one_tracker_moves_two_tools(void **state)
{
    struct viewer viewer;
    struct window window;
    struct notice notice;
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    uint8_t lost[4096];
    (void)state;
    open_window(&window, &viewer);
    window.inputs.station = start(NULL, "Left"); /* the first tool is any other */
    window.inputs.has_second_tool = true;
    tool_use_second(&viewer, true);
    tool_choose(window.viewer, FIRST_TOOL, POINT_BY_TRACKER);
    tool_choose(window.viewer, SECOND_TOOL, POINT_BY_TRACKER);
    int peer = connect_to(window.inputs.station);
    while (!viewer.tools[FIRST_TOOL].has_pose) {
        send_pose(peer, "RightToTracker", 50);
        step(&window);
    }
    send_until_seen(&window, peer, "LeftToTracker", 70);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], 50, 1e-5);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 70, 1e-5);
    check_answer(&window);
    send_until_seen(&window, peer, "LeftToTracker", 60);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], 50, 1e-5);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 60, 1e-5);
    assert_true(send(peer, lost, igtl_write_transform(lost, sizeof lost, "LeftToTracker", 2, identity), 0) > 0);
    step_until(&window, STATION_LOST);
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_true(notice.is_old);
    assert_non_null(strstr(notice.text, "the tool is lost"));
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 60, 1e-5);
    tool_hold(&viewer, SECOND_TOOL);
    tool_hold(&viewer, FIRST_TOOL);
    do {
        send_pose(peer, "RightToTracker", 30);
        send_until_seen(&window, peer, "LeftToTracker", 40);
    } while (fabs(window.inputs.devices.trackers[FIRST_TOOL].tool.pose.world_from_device[13] - 30) > 1e-5);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 60, 1e-5);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], 50, 1e-5); /* the first one is held, too */
    inputs_notice(&notice, &window.inputs, window.viewer, FIRST_TOOL);
    assert_non_null(strstr(notice.text, "held"));
    tool_hold(&viewer, FIRST_TOOL);
    while (fabs(viewer.tools[FIRST_TOOL].pose.world_from_device[13] - 30) > 1e-5) {
        send_pose(peer, "RightToTracker", 30);
        step(&window);
    }
    close(peer);
    station_stop(window.inputs.station);
    close_window(&window);
}

/* The second tool has a tracker for itself, while the mouse moves the first one. */
static void the_second_tool_has_a_tracker_of_its_own(void **state)
{
    struct viewer viewer;
    struct window window;
    struct notice notice;
    (void)state;
    open_window(&window, &viewer);
    window.inputs.second_station = start(NULL, NULL);
    tool_use_second(&viewer, true);
    tool_choose(window.viewer, SECOND_TOOL, POINT_BY_TRACKER);
    assert_true(isfinite(inputs_idle_s(&window.inputs, window.viewer)));
    int peer = connect_to(window.inputs.second_station);
    send_until_seen(&window, peer, "Any", 45);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 45, 1e-5);
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_null(notice.text);
    close(peer);
    step_until(&window, STATION_WAITING);
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_non_null(strstr(notice.text, "no tracker is connected"));
    station_stop(window.inputs.second_station);
    close_window(&window);
}

static void stuck_and_invalid_trackers_are_reported(void **state)
{
    struct viewer viewer;
    struct window window;
    struct notice notice;
    struct tracker *tracker = &window.inputs.devices.trackers[SECOND_TOOL];
    struct station_tool tool = {.state = STATION_SEEN, .number = 1};
    struct source_update update;
    (void)state;
    open_window(&window, &viewer);
    assert_ok(conus_pose_along(&tool.pose, eye, back, NULL));
    tracker_hear(tracker, &tool);
    source_ask(&tracker->source, 10, &update);
    assert_int_equal(update.state, SOURCE_WELL);
    assert_true(update.has_pose);
    source_ask(&tracker->source, 14.9, &update);
    assert_int_equal(update.state, SOURCE_WELL);
    assert_false(update.has_pose); /* each pose once */
    source_ask(&tracker->source, 15, &update);
    assert_int_equal(update.state, SOURCE_FROZEN);
    window.inputs.devices.received[SECOND_TOOL] = update;
    window.viewer->tools[SECOND_TOOL].pointer = POINT_BY_TRACKER;
    window.viewer->tools[SECOND_TOOL].has_pose = true;
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_true(notice.is_trouble && !notice.is_old);
    assert_non_null(strstr(notice.text, "frozen"));
    assert_null(strstr(notice.text, "held"));
    window.viewer->tools[SECOND_TOOL].held = true;
    inputs_notice(&notice, &window.inputs, window.viewer, SECOND_TOOL);
    assert_non_null(strstr(notice.text, "held"));
    assert_non_null(strstr(notice.text, "frozen"));
    window.viewer->tools[SECOND_TOOL].held = false;
    tool.pose.world_from_device[12] += 1e-9;
    tool.number = 2;
    tracker_hear(tracker, &tool);
    source_ask(&tracker->source, 15.1, &update);
    assert_int_equal(update.state, SOURCE_WELL);
    tool.pose.world_from_device[12] = NAN;
    tool.number = 3;
    tracker_hear(tracker, &tool);
    source_ask(&tracker->source, 15.2, &update);
    assert_int_equal(update.state, SOURCE_BROKEN);
    assert_false(update.has_pose);
    source_ask(NULL, 16, &update);
    assert_int_equal(update.state, SOURCE_NONE);
    close_window(&window);
}

/* A cone of 60 degrees from the origin along -z, to 100 mm: far is the ring of radius 50 at z = -86.6. The plane z =
 * -30 cuts it in a circle of radius 30 tan 30; the plane x = 0, through the apex, in two lines of 100 mm; that of a
 * polygon of 64 corners is up to 1 - cos(pi / 64), 0.12 %, smaller. */
static void the_wall_is_cut_by_planes(void **state)
{
    struct shell shell;
    struct shell_piece pieces[2 * SHELL_POINTS];
    conus_pose pose;
    double along = 0;
    (void)state;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 0}, (double[]){0, 0, -1}, NULL));
    shell_find(&shell, &pose, 0, 60, 0, 100 * cos(M_PI / 6));
    for (size_t i = 0; i < SHELL_POINTS; i++) {
        assert_near(hypot(shell.far[i][0], shell.far[i][1]), 50, 1e-9);
        assert_near(shell.far[i][2], -100 * cos(M_PI / 6), 1e-9);
        assert_near(hypot(hypot(shell.near[i][0], shell.near[i][1]), shell.near[i][2]), 0, 1e-9);
        assert_near(shell.out[i][2], sin(M_PI / 6), 1e-12); /* out of the wall is back to the apex's side */
    }
    size_t count = shell_cut(pieces, &shell, (double[]){7, 8, -30}, (double[]){0, 0, 1});
    assert_true(count >= SHELL_POINTS);
    double radius = 30 * tan(M_PI / 6);
    for (size_t i = 0; i < count; i++) {
        const double *end = pieces[i].ends[0];
        assert_near(end[2], -30, 1e-9);
        assert_near(hypot(end[0], end[1]), radius, 0.0013 * radius);
    }
    count = shell_cut(pieces, &shell, (double[]){0, 0, 0}, (double[]){1, 0, 0});
    for (size_t i = 0; i < count; i++) {
        const double *a = pieces[i].ends[0];
        const double *b = pieces[i].ends[1];
        along += hypot(a[1] - b[1], a[2] - b[2]);
    }
    assert_near(along, 200, 0.3);
    assert_int_equal(shell_cut(pieces, &shell, (double[]){0, 0, 5}, (double[]){0, 0, 1}), 0);
    size_t turns = 0;
    for (size_t i = 0; i < SHELL_POINTS; i++) {
        turns += shell_turns(&shell, i, (double[]){300, 0, -50});
    }
    assert_int_equal(turns, 2); /* seen from the side a cone has two outlines */
}

/* A quarter turn to the left about its +y takes -z, where it points, to -x; the way before that is along its own axes.
 */
static void a_tool_is_steered_along_its_own_axes(void **state)
{
    struct viewer viewer;
    struct window window;
    const double none[3] = {0, 0, 0};
    (void)state;
    open_window(&window, &viewer);
    inputs_steer(&viewer, SECOND_TOOL, none, none); /* the first time it is put there: to the right, looking left */
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[12], viewer.centre[0] + 1.6 * viewer.radius,
                1e-9);
    assert_near(-window.viewer->tools[SECOND_TOOL].pose.world_from_device[8], -1, 1e-12);
    conus_pose pose = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    tool_aim(window.viewer, SECOND_TOOL, &pose);
    inputs_steer(&viewer, SECOND_TOOL, (double[]){1, 2, -3}, (double[]){0, M_PI / 2, 0});
    const double *m = window.viewer->tools[SECOND_TOOL].pose.world_from_device;
    assert_near(m[12], 1, 1e-12);
    assert_near(m[13], 2, 1e-12);
    assert_near(m[14], -3, 1e-12);
    assert_near(-m[8], -1, 1e-12);
    inputs_steer(&viewer, SECOND_TOOL, (double[]){0, 0, -5}, none); /* forward, which is -x now */
    assert_near(m[12], -4, 1e-9);
    for (int i = 0; i < 2000; i++) { /* it stays a rotation, and near the brain */
        inputs_steer(&viewer, SECOND_TOOL, (double[]){3, 0, -5}, (double[]){0.0001, 0.0002, 0.0003});
    }
    conus_pose exact;
    assert_ok(conus_pose_from_matrix(&exact, m));
    double far = 0;
    for (int a = 0; a < 3; a++) {
        far = hypot(far, m[12 + a] - viewer.centre[a]);
    }
    assert_near(far, 3 * viewer.radius, 1e-6);
    close_window(&window);
}

static void sessions_keep_it_and_changes_are_taken_back(void **state)
{
    struct viewer viewer;
    struct window window;
    char why[PROPERTY_REASON];
    (void)state;
    open_window(&window, &viewer);
    aim(&window, (double[]){60, 1, 2}, (double[]){-1, 0, 0});
    tool_use_second(&viewer, true);
    window.viewer->tools[SECOND_TOOL].angle = 33;
    window.viewer->tools[SECOND_TOOL].held = true;
    tool_choose(window.viewer, SECOND_TOOL, POINT_BY_WAND);
    undo_note(&window);
    char *text = session_text(&window);
    assert_non_null(text);
    aim(&window, (double[]){0, 60, 0}, back);
    undo_note(&window);
    window.viewer->tools[SECOND_TOOL].angle = 12;
    tool_changed(window.viewer, SECOND_TOOL);
    undo_step(&window, -1);
    assert_near(window.viewer->tools[SECOND_TOOL].angle, 33, 0);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 60, 0);
    undo_step(&window, -1);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[12], 60, 0);
    undo_step(&window, -1);
    assert_false(window.viewer->tools[SECOND_TOOL].on);
    assert_true(session_parse(&window, text, strlen(text), why));
    assert_true(window.viewer->tools[SECOND_TOOL].on && window.viewer->tools[SECOND_TOOL].held);
    assert_near(window.viewer->tools[SECOND_TOOL].angle, 33, 0);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[12], 60, 0);
    char *place = strstr(text, "\"angle_deg\": 33");
    assert_non_null(place);
    memcpy(strstr(place, "33"), "-3", 2);
    assert_false(session_parse(&window, text, strlen(text), why));
    assert_non_null(strstr(why, "second: "));
    assert_near(window.viewer->tools[SECOND_TOOL].angle, 33, 0);
    free(text);
    close_window(&window);
}

static void a_script_does_what_its_words_say(void **state)
{
    static const struct {
        size_t count;
        char *words[8];
        bool fine;
    } cases[] = {
        {2, {"second", "on"}, true},
        {8, {"second", "aim", "0", "90", "0", "0", "0", "0"}, true},
        {8, {"second", "aim", "0", "90", "0", "0", "90", "0"}, false},
        {7, {"second", "aim", "0", "90", "0", "0", "0"}, false},
        {3, {"second", "angle", "7"}, true},
        {3, {"second", "angle", "180"}, false},
        {3, {"second", "pointer", "tracker"}, true},
        {3, {"second", "pointer", "replay"}, false},
        {2, {"second", "hold"}, true},
        {2, {"second", "hop"}, false},
        {3, {"second", "results", "/nowhere/there"}, false},
        {3, {"second", "confirm", "it"}, false},
    };
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (script_do(&window, cases[i].words, cases[i].count) != cases[i].fine) {
            fail_msg("case %zu", i);
        }
    }
    assert_true(window.viewer->tools[SECOND_TOOL].on && window.viewer->tools[SECOND_TOOL].held);
    assert_near(window.viewer->tools[SECOND_TOOL].pose.world_from_device[13], 90, 0);
    assert_near(window.viewer->tools[SECOND_TOOL].angle, 7, 0);
    assert_int_equal(window.viewer->tools[SECOND_TOOL].pointer, POINT_BY_TRACKER);
    close_window(&window);
}

TEST_GROUP(second)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_tool_has_answers_of_its_own),
        cmocka_unit_test(its_table_is_that_of_its_answers),
        cmocka_unit_test(shapes_are_shared),
        cmocka_unit_test(a_device_moves_one_tool),
        cmocka_unit_test(one_tracker_moves_two_tools),
        cmocka_unit_test(the_second_tool_has_a_tracker_of_its_own),
        cmocka_unit_test(stuck_and_invalid_trackers_are_reported),
        cmocka_unit_test(the_wall_is_cut_by_planes),
        cmocka_unit_test(a_tool_is_steered_along_its_own_axes),
        cmocka_unit_test(sessions_keep_it_and_changes_are_taken_back),
        cmocka_unit_test(a_script_does_what_its_words_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
