/* SPDX-License-Identifier: BSD-3-Clause */
/* One frame of the window: its panels and panes. */
#include "viewer/draw.h"

#include "viewer/commands/keys.h"
#include "viewer/panes/panels.h"
#include "viewer/panes/panes.h"
#include "viewer/ui/ui_navigate.h"

#include <GLFW/glfw3.h>
#include <math.h>

/* A click on anything gives the keys back to the panes. */
static void navigate(struct window *window)
{
    static const char *const panels[] = {NULL, "Areas", "Hits of the cone"};
    const struct ui_mouse mouse = ui_mouse_now();
    bool is_pressed = mouse.pressed[0] || mouse.pressed[1] || mouse.pressed[2];
    bool ends = ui_navigates() && (is_pressed || window->start.on || window->screen.alone);
    if (window->frame.navigates_anew || ends) {
        window->frame.navigated = ends ? 0 : window->frame.navigated;
        window->frame.navigates_anew = false;
        ui_navigate(panels[window->frame.navigated]);
    }
}

/* What was tapped is down for one frame. */
static void tap(struct window *window, bool down)
{
    if (window->frame.tapped && (down || glfwGetKey(window->handle, window->frame.tapped) != GLFW_PRESS)) {
        ui_hold_key(window->frame.tapped, down);
    }
    window->frame.tapped = down ? window->frame.tapped : 0;
}

static void draw_panels(struct window *window)
{
    window->frame.hover = (struct hover){.value = NAN};
    if (window->dialog.on) {
        panel_dialog(window);
        return;
    }
    if (window->start.on) {
        panel_start(window);
        return;
    }
    pane_borders(window); /* first, so that they lie in front */
    if (!window->screen.alone) {
        panel_areas(window);
        panel_results(window);
    }
    for (int p = 0; p < PLANE_COUNT; p++) {
        if (window_shows_pane(window, p)) {
            pane_cut(window, (enum plane)p);
        }
    }
    if (window_shows_pane(window, PANE_3D)) {
        pane_3d(window);
    }
    if (!window->screen.alone) { /* after the panes, which find what is under the mouse */
        panel_status(window);
    }
}

/* What the newest frame shows of the viewer. */
static void note_shown(struct window *window)
{
    window->frame.frames_wanted -= window->frame.frames_wanted > 0;
    if (window->viewer) {
        window->frame.shown_version = window->viewer->version;
        window->frame.shown_said = window->viewer->said;
        window->frame.shown_second = window->viewer->tools[SECOND_TOOL].version;
        window->frame.shown_head = window->viewer->head.number;
    }
}

void draw_window(struct window *window)
{
    double begun = glfwGetTime();
    note_shown(window);
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
    tap(window, true);
    ui_begin();
    navigate(window);
    draw_panels(window);
    if (window->forms.show_help) {
        keys_draw_help(window);
    }
    if (window->forms.figure.open && window->viewer && !window->start.on) {
        panel_figure(window);
    }
    if (window->forms.added.open && window->viewer && !window->start.on && !window->dialog.on) {
        panel_added(window);
    }
    ui_end();
    tap(window, false);
    window->frame.ms = 1e3 * (glfwGetTime() - begun);
    times_add(&window->times, TIMED_FRAME, window->frame.ms);
}
