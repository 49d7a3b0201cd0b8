/* SPDX-License-Identifier: BSD-3-Clause */
/* The loop of the window: waits, polls devices, draws frames of panels and panes. */
#include "viewer/loop.h"

#include "link/station.h"
#include "viewer/commands/commands.h"
#include "viewer/model/additions.h"
#include "viewer/model/viewer.h"
#include "viewer/panes/panes.h"
#include "viewer/session/session.h"
#include "viewer/ui/ui.h"
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

static const double longest_s = 2;     /* longest sleep; files are looked at after each */
static const double watch_s = 0.2;     /* how often a tracker that says nothing is looked at */
static const double blink_s = 0.2;     /* of the mark where text is typed */
static const double patience_s = 0.02; /* of a script that waits for a file */

/* Thousands of poses a second shall not fill the queue of events. */
static atomic_bool awake;

void loop_wake(void)
{
    if (!atomic_exchange(&awake, true)) {
        glfwPostEmptyEvent();
    }
}

/* Lets trackers and other devices move the tools. */
static void hear_devices(struct window *window)
{
    uint64_t before = window->inputs.update.number;
    bool aimed = inputs_step(&window->inputs, window->viewer, 1e-3 * clock_ms());
    if (aimed && window->viewer->tools[FIRST_TOOL].pointer == POINT_BY_TRACKER &&
        window->inputs.update.number != before) {
        times_add(&window->times, TIMED_LATENCY,
                  1e3 * window->inputs.update.age_s + window->viewer->tools[FIRST_TOOL].select_ms);
    }
}

/* Sends the selection in the first atlas to all that are connected. */
static void send_answer(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const struct view_atlas *first = viewer->atlases;
    if (window->inputs.update.clients && tool_has_cone(viewer, FIRST_TOOL) && first->answers[FIRST_TOOL] &&
        first->selector && window->frame.sent_answer != viewer->tools[FIRST_TOOL].answer_number) {
        station_send_selection(window->inputs.station, first->selector, first->atlas,
                               view_atlas_selection(first, FIRST_TOOL));
        window->frame.sent_answer = viewer->tools[FIRST_TOOL].answer_number;
    }
}

static void watch_files(struct window *window)
{
    char update[FILE_WATCH_TEXT];
    double now = clock_ms();
    if (now - window->frame.watched < 1e3 * longest_s) {
        return;
    }
    window->frame.watched = now;
    for (size_t i = 0; i < window->viewer->atlas_count; i++) {
        if (file_watch_check(window->viewer->atlases[i].watch, update)) {
            viewer_say(window->viewer, "%s", update);
        }
    }
}

/* Seconds until something changes by itself. */
static double idle_s(const struct window *window, const struct script *script)
{
    double seconds = window_idle_s(window);
    if (script) {
        seconds = fmin(seconds, patience_s);
    }
    if (window->inputs.station) {
        seconds = fmin(seconds, watch_s);
    }
    if (ui_wants_keys()) {
        seconds = fmin(seconds, blink_s);
    }
    if (window->viewer) {
        seconds = fmin(seconds, inputs_idle_s(&window->inputs, window->viewer));
        seconds = fmin(seconds, replay_idle_s(&window->inputs.replay, window->viewer, glfwGetTime()));
    }
    return fmin(seconds, longest_s);
}

/* Not while a mouse button is down, a text is typed or a trigger changes an angle: more of the change may come. */
static void note_changes(struct window *window)
{
    struct ui_mouse mouse = ui_mouse_now();
    bool widens =
        window->inputs.devices.received[FIRST_TOOL].widen > 0 || window->inputs.devices.received[SECOND_TOOL].widen > 0;
    if (window->viewer && !widens && !mouse.down[0] && !mouse.down[1] && !mouse.down[2] && !ui_wants_keys()) {
        undo_note(window);
    }
}

/* A click on anything gives the keys back to the panes. */
static void navigate(struct window *window)
{
    static const char *const panels[] = {NULL, "Areas", "Hits of the cone"};
    const struct ui_mouse mouse = ui_mouse_now();
    bool is_pressed = mouse.pressed[0] || mouse.pressed[1] || mouse.pressed[2];
    bool ends = window->frame.navigated && (is_pressed || window->start.on || screen_is_bare(&window->screen));
    if (window->frame.navigates_anew || ends) {
        window->frame.navigated = ends ? 0 : window->frame.navigated;
        window->frame.navigates_anew = !ui_navigate(panels[window->frame.navigated]); /* it may open in this frame */
    }
}

static void draw_panels(struct window *window)
{
    window->frame.hover = (struct hover){.value = NAN};
    memset(window->frame.shows, 0, sizeof window->frame.shows);
    if (window->dialog.on) {
        panel_dialog(window);
        return;
    }
    if (window->start.on) {
        panel_start(window);
        return;
    }
    pane_borders(window); /* first, so that they lie in front */
    panel_views(window);
    if (!screen_is_bare(&window->screen)) { /* before the panes: the list shows an answer to the mouse there one frame
                                               later */
        panel_areas(window);
        panel_results(window);
    }
    for (int p = 0; p < PLANE_COUNT; p++) {
        if (screen_shows_pane(&window->screen, p)) {
            pane_cut(window, (enum plane)p);
        }
    }
    if (screen_shows_pane(&window->screen, PANE_3D)) {
        pane_3d(window);
    }
    if (!screen_is_bare(&window->screen)) { /* after the panes, which find what is under the mouse */
        panel_status(window);
    }
}

static void draw_window(struct window *window)
{
    double begun = glfwGetTime();
    window->frame.frames_wanted -= window->frame.frames_wanted > 0;
    if (window->viewer) { /* the versions that this frame shows */
        window->frame.shown_version = window->viewer->version;
        window->frame.shown_said = window->viewer->said;
        window->frame.shown_second = window->viewer->tools[SECOND_TOOL].version;
        window->frame.shown_head = window->viewer->head.number;
    }
    window->pictures.moving = window->pictures.moving && clock_ms() < window->pictures.moving_until;
    window_lay_out(window);
    if (window->screen.width < 1 || window->screen.height < 1) { /* minimised */
        return;
    }
    if (window->screen.next_scale > 0 && ui_set_scale(window->screen.next_scale)) {
        window->screen.scale = window->screen.next_scale;
        window_lay_out(window);
    }
    window->screen.next_scale = 0;
    window_clear(window);
    ui_navigate_lists(window->frame.navigated);
    ui_begin(window->events.time);
    navigate(window);
    ui_disable(window_asks(window)); /* the question is before all else */
    draw_panels(window);
    if (window->forms.show_help) {
        keys_draw_help(window);
    }
    const bool has_forms = window->viewer && !window->start.on && !window->dialog.on;
    if (window->forms.figure.open && has_forms) {
        panel_figure(window);
    }
    if (window->forms.added.open && has_forms) {
        panel_added(window);
    }
    ui_disable_end();
    if (window_asks(window)) {
        panel_ask(window);
    }
    ui_end();
    window->frame.ms = 1e3 * (glfwGetTime() - begun);
    times_add(&window->times, TIMED_FRAME, window->frame.ms);
}

static void draw_frame(struct window *window)
{
    bool writes = window->files.saves_as; /* which the frame before asked for, of another page */
    times_begin_frame(&window->times);
    draw_window(window);
    title_update(window);
    note_changes(window);
    if (writes) {
        save_file_as(window);
    }
    figure_form_step(window);
}

/* One round. False: the script has ended. */
static bool go_round(struct window *window, struct script *script, int *code)
{
    bool acts = script && !script_waits(script, window);
    unsigned answer = window->viewer ? window->viewer->tools[FIRST_TOOL].answer_number : 0;
    double seconds = acts ? 0 : idle_s(window, script);
    if (seconds > 0) {
        window->times.frame_started = 0; /* the next frame does not follow from the one before */
        glfwWaitEventsTimeout(seconds);
    } else {
        glfwPollEvents();
    }
    atomic_store(&awake, false);
    events_take(window);
    if (window->viewer) {
        hear_devices(window);
        if (window->inputs.station) {
            send_answer(window);
        }
        watch_files(window);
        replay_step(&window->inputs.replay, window->viewer, glfwGetTime());
        studies_step(window->viewer);
        plans_step(window->viewer);
    }
    if (!window_needs_frame(window) && !acts && !ui_wants_keys()) {
        return true;
    }
    draw_frame(window);
    if (window_has_request(window)) { /* the script's next command is about the atlas that was dropped in this round */
        return true;
    }
    if (acts && script_step(script, window, code)) {
        return false;
    }
    glfwSwapBuffers(window->handle);
    if (window->viewer) {
        struct times *times = &window->times;
        times->first_frame = times->first_frame > 0 ? times->first_frame : clock_ms() - times->started;
        if (window->viewer->tools[FIRST_TOOL].answer_number != answer) { /* this frame is the first that shows it */
            times_add(times, TIMED_SELECTION, window->viewer->tools[FIRST_TOOL].select_ms);
        }
    }
    return true;
}

/* Whether it closes, unless what was made by hand would be lost: then that is asked first. */
static bool closes(struct window *window)
{
    if (!glfwWindowShouldClose(window->handle)) {
        return false;
    }
    const char *lost = session_lacks(window);
    if (window->forms.closes || !lost) {
        return true;
    }
    glfwSetWindowShouldClose(window->handle, GLFW_FALSE);
    glfwShowWindow(window->handle); /* closed while files were read, it is hidden */
    window->forms.closing_loses = lost;
    window->frame.frames_wanted = FRAMES_PER_EVENT;
    return false;
}

bool loop_run(struct window *window, struct script *script, int *code)
{
    bool goes_on = true;
    while (goes_on && !closes(window) && !window_has_request(window)) {
        goes_on = go_round(window, script, code);
    }
    for (size_t left = window->events.count; left && glfwWindowShouldClose(window->handle); left--) {
        events_take(window); /* what came before */
    }
    return goes_on && !glfwWindowShouldClose(window->handle);
}
