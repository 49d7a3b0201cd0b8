/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of undo and redo, without a window. */
#include "viewer/session/session.h"

#include "session_words.h"
#include "test.h"
#include "window_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void add(struct changes *changes, const char *state)
{
    changes_add(changes, strdup(state));
}

static void a_history_goes_back_and_forth(void **state)
{
    struct changes changes = {.count = 0};
    (void)state;
    assert_null(changes_step(&changes, -1));
    assert_null(changes_step(&changes, 1));
    add(&changes, "a");
    assert_null(changes_step(&changes, -1));
    add(&changes, "b");
    add(&changes, "b"); /* is no change */
    add(&changes, "c");
    assert_string_equal(changes_step(&changes, -1), "b");
    assert_string_equal(changes_step(&changes, -1), "a");
    assert_null(changes_step(&changes, -1));
    assert_string_equal(changes_step(&changes, 1), "b");
    add(&changes, "b"); /* nor does this one drop c */
    assert_string_equal(changes_step(&changes, 1), "c");
    assert_null(changes_step(&changes, 1));
    assert_string_equal(changes_step(&changes, -1), "b");
    add(&changes, "d");
    assert_null(changes_step(&changes, 1)); /* c is gone */
    assert_string_equal(changes_step(&changes, -1), "b");
    changes_finish(&changes);
    assert_null(changes_step(&changes, -1));
}

static void the_oldest_states_go(void **state)
{
    struct changes changes = {.count = 0};
    char text[16];
    (void)state;
    for (int i = 0; i < CHANGES_LIMIT + 3; i++) {
        snprintf(text, sizeof text, "%d", i);
        add(&changes, text);
    }
    int steps = 0;
    const char *last = NULL;
    for (const char *found; (found = changes_step(&changes, -1)); last = found) {
        steps++;
    }
    assert_int_equal(steps, CHANGES_LIMIT - 1);
    assert_string_equal(last, "3");
    changes_finish(&changes);
}

static const double eye[3] = {0, 90, 0};
static const double back[3] = {0, -1, 0};

static void open_window(struct window *out, struct viewer *viewer)
{
    window_scene_open(out, viewer);
    undo_note(out);
}

static void close_window(struct window *window)
{
    changes_finish(&window->history.changes);
    free(window->history.session_path);
    viewer_finish(window->viewer);
}

static void set_angle(struct window *window, double angle)
{
    window->viewer->tools[FIRST_TOOL].angle = angle;
    tool_reselect(window->viewer);
    undo_note(window);
}

/* Each kind of change is taken back by itself, in the reverse order. */
static void each_change_is_taken_back(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer);
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_WAND;
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    undo_note(&window);
    set_angle(&window, 12);
    viewer_hide(&viewer, 1, true);
    undo_note(&window);
    tool_confirm(&viewer, FIRST_TOOL);
    undo_note(&window);
    viewer_use_safe_colours(&viewer, true);
    undo_note(&window);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 0, 80}, (double[]){0, 0, -1});
    undo_step(&window, -1); /* notes that itself */
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], 90, 1e-12);
    assert_true(viewer.display.safe_colours);
    undo_step(&window, -1);
    assert_false(viewer.display.safe_colours);
    assert_int_equal(viewer.pin_count, 1);
    undo_step(&window, -1);
    assert_int_equal(viewer.pin_count, 0);
    assert_true(viewer.drawn->shown.hidden[1]);
    undo_step(&window, -1);
    assert_false(viewer.drawn->shown.hidden[1]);
    assert_int_equal(conus_selection_result(viewer_selection(&viewer), 0)->object, 1); /* the outermost ball */
    assert_near(viewer.tools[FIRST_TOOL].angle, 12, 1e-12);
    undo_step(&window, -1);
    assert_near(viewer.tools[FIRST_TOOL].angle, 5, 1e-12);
    undo_step(&window, -1);
    assert_int_equal(viewer.tools[FIRST_TOOL].pointer, POINT_BY_MOUSE); /* the mouse's cone is where the mouse is */
    undo_step(&window, -1);
    assert_string_equal(viewer.message, "nothing to undo");
    for (int i = 0; i < 6; i++) {
        undo_step(&window, 1);
    }
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[14], 80, 1e-12);
    assert_int_equal(viewer.pin_count, 1);
    assert_true(viewer.drawn->shown.hidden[1] && viewer.display.safe_colours);
    undo_step(&window, 1);
    assert_string_equal(viewer.message, "nothing to do again");
    close_window(&window);
}

/* A change of the panes is a change by itself; a session without their sizes leaves them. */
static void borders_are_put_back(void **state)
{
    struct viewer viewer;
    struct window window;
    char why[PROPERTY_REASON];
    const struct layout first = {.panels = {0, 320}};
    const struct layout moved = {.panels = {310.5, 320}, .division = {0.25, 0.7}};
    (void)state;
    open_window(&window, &viewer);
    window.screen.layout = first;
    undo_note(&window);
    size_t count = window.history.changes.count;
    undo_note(&window);
    assert_int_equal(window.history.changes.count, count);
    window.screen.layout = moved;
    undo_note(&window);
    assert_int_equal(window.history.changes.count, count + 1);
    set_angle(&window, 12);
    undo_step(&window, -1);
    assert_near(viewer.tools[FIRST_TOOL].angle, 5, 1e-12);
    assert_true(layout_is_same(&window.screen.layout, &moved));
    undo_step(&window, -1);
    assert_true(layout_is_same(&window.screen.layout, &first));
    undo_step(&window, 1);
    assert_true(layout_is_same(&window.screen.layout, &moved));
    char *text = session_text(&window);
    char *key = strstr(text, "\"layout\"");
    assert_non_null(key);
    char *part = strstr(key, "0.25");
    assert_non_null(part);
    window.screen.layout = first;
    *part = '9';
    assert_false(session_parse(&window, text, strlen(text), why));
    assert_non_null(strstr(why, "session: layout: panels"));
    assert_true(layout_is_same(&window.screen.layout, &first));
    *part = '0';
    assert_true(session_parse(&window, text, strlen(text), why));
    assert_true(layout_is_same(&window.screen.layout, &moved));
    memcpy(key, "\"nought\"", 8); /* a key that no session has */
    window.screen.layout = first;
    assert_true(session_parse(&window, text, strlen(text), why));
    assert_true(layout_is_same(&window.screen.layout, &first));
    free(text);
    close_window(&window);
}

/* Undoing the first pose removes its answer, too. */
static void without_a_device_there_is_no_answer(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer);
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_WAND;
    viewer.version++;
    undo_note(&window);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    undo_note(&window);
    undo_step(&window, -1);
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    assert_null(viewer_selection(&viewer));
    undo_step(&window, 1);
    assert_int_equal(conus_selection_result(viewer_selection(&viewer), 0)->object, 1);
    close_window(&window);
}

static void views_and_what_moves_by_itself_stay(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    open_window(&window, &viewer);
    set_angle(&window, 12);
    viewer.orbit.azimuth = 1;
    viewer_cross(&viewer, (double[]){1, 2, 3});
    tool_aim_along(&viewer, FIRST_TOOL, eye, back); /* the mouse's cone */
    undo_note(&window);
    undo_step(&window, -1);
    assert_near(viewer.tools[FIRST_TOOL].angle, 5, 1e-12);
    assert_near(viewer.orbit.azimuth, 1, 1e-12);
    assert_near(viewer.crosshair[2], 3, 1e-12);
    assert_true(viewer.tools[FIRST_TOOL].has_pose);
    undo_step(&window, 1);
    viewer.tools[FIRST_TOOL].held = true; /* a cone that is held is the user's */
    viewer.version++;
    undo_note(&window);
    viewer.tools[FIRST_TOOL].held = false;
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 0, 80}, (double[]){0, 0, -1});
    undo_step(&window, -1);
    assert_true(viewer.tools[FIRST_TOOL].held);
    assert_near(viewer.tools[FIRST_TOOL].pose.world_from_device[13], 90, 1e-12);
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_TRACKER;
    viewer.version++;
    undo_note(&window);
    size_t count = window.history.changes.count;
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 0, 80}, (double[]){0, 0, -1});
    undo_note(&window);
    assert_int_equal(window.history.changes.count, count);
    close_window(&window);
}

/* Adds a file that has no objects here, as opening the window again with it does. */
static void add_file(struct window *window)
{
    static const char word[] = "--streamlines=/nowhere/two.tck";
    json_decref(window->files.opened);
    window->files.opened = json_pack("{s: [s], s: [{s: s, s: s, s: []}]}", "options", word, "added", "option", word,
                                     "path", "/nowhere/two.tck", "objects");
    assert_non_null(window->files.opened);
    undo_renew(window);
}

/* Adding a file is no change of its own, and does not prevent older changes from being taken back. */
static void changes_before_a_file_was_added_are_all_taken_back(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    window.files.opened = json_pack("{s: [], s: []}", "options", "added");
    undo_note(&window);
    for (int i = 0; i < 3; i++) {
        set_angle(&window, 12 + i);
    }
    add_file(&window);
    json_t *opened = json_deep_copy(window.files.opened);
    for (int i = 0; i < 3; i++) {
        undo_step(&window, -1);
        assert_near(viewer.tools[FIRST_TOOL].angle, i == 2 ? 5 : 13 - i, 1e-12);
        undo_note(&window); /* called after each frame */
    }
    assert_true(json_equal(opened, window.files.opened)); /* files in a state do not say which files are open */
    json_decref(opened);
    undo_step(&window, -1);
    assert_string_equal(viewer.message, "nothing to undo");
    for (int i = 0; i < 3; i++) {
        undo_step(&window, 1);
        assert_near(viewer.tools[FIRST_TOOL].angle, 12 + i, 1e-12);
        undo_note(&window);
    }
    json_decref(window.files.opened);
    close_window(&window);
}

/* To reach the state the atlas has to be opened again, which does not happen here. */
static void a_state_that_is_not_reached_stays(void **state)
{
    struct viewer viewer;
    struct window window;
    (void)state;
    window_scene_open(&window, &viewer);
    window.files.opened = json_pack("{s: [], s: []}", "options", "added");
    undo_note(&window);
    set_angle(&window, 12);
    json_object_set_new(window.files.opened, "options", json_pack("[s]", "--hemispheres=split"));
    window.files.hemispheres = CONUS_HEMISPHERES_SPLIT;
    set_angle(&window, 13);
    size_t at = window.history.changes.at;
    undo_step(&window, -1);
    assert_true(window_has_request(&window));
    assert_int_equal(window.files.requested.step, -1);
    assert_int_equal(window.history.changes.at, at); /* it is not there yet */
    open_request_finish(&window.files.requested);
    undo_renew(&window);
    assert_non_null(strstr(window.history.changes.states[at - 1], "\"angle_deg\":12"));
    json_decref(window.files.opened);
    close_window(&window);
}

TEST_GROUP(undo)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_history_goes_back_and_forth),
        cmocka_unit_test(the_oldest_states_go),
        cmocka_unit_test(each_change_is_taken_back),
        cmocka_unit_test(without_a_device_there_is_no_answer),
        cmocka_unit_test(views_and_what_moves_by_itself_stay),
        cmocka_unit_test(borders_are_put_back),
        cmocka_unit_test(changes_before_a_file_was_added_are_all_taken_back),
        cmocka_unit_test(a_state_that_is_not_reached_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
