/* SPDX-License-Identifier: BSD-3-Clause */
/* The second tool: what moves it, its angle, and the list of what its cone hits. */
#include "viewer/panes/panes.h"

#include "base/look.h"

#include <stdio.h>

/* Offers all pointers but the replay. */
static void choose_pointer(struct window *window)
{
    static const enum pointer places[] = {POINT_BY_MOUSE, POINT_BY_WAND, POINT_BY_TRACKER, POINT_BY_SPACEMOUSE,
                                          POINT_BY_GAMEPAD};
    enum { PLACES = sizeof places / sizeof places[0] };
    const char *names[PLACES];
    size_t chosen = 0;
    for (size_t i = 0; i < PLACES; i++) {
        names[i] = pointer_names[places[i]];
        chosen = places[i] == window->viewer->tools[SECOND_TOOL].pointer ? i : chosen;
    }
    if (ui_choose("Point with", &chosen, names, PLACES,
                  "what moves the second tool: another device than the first one's, or another tool of a tracker; 3: "
                  "the next")) {
        tool_choose(window->viewer, SECOND_TOOL, places[chosen]);
    }
}

static void choose_settings(struct window *window)
{
    struct viewer *viewer = window->viewer;
    struct tool *second = &viewer->tools[SECOND_TOOL];
    choose_pointer(window);
    panel_speed(window, second->pointer);
    panel_property(window, PROPERTY_SECOND_ANGLE);
    bool held = second->held;
    if (ui_check("Hold", &held, "nothing moves the second tool; 4 changes it")) {
        tool_hold(viewer, SECOND_TOOL);
    }
    ui_same_line();
    if (ui_button("Keep its hit", "keeps the best hit of the second cone")) {
        inputs_confirm(&window->inputs, viewer, SECOND_TOOL);
    }
}

void panel_second(struct window *window)
{
    struct notice notice;
    char text[128];
    bool on = window->viewer->tools[SECOND_TOOL].on;
    ui_id(2); /* widgets have the names of the first tool's */
    if (ui_check("Second tool", &on,
                 "another cone, of another device, with a list of its own; 2 switches it on and off")) {
        tool_use_second(window->viewer, on);
    }
    if (window->viewer->tools[SECOND_TOOL].on) {
        tool_update_second(window->viewer); /* the panel of areas may have changed the atlas in this frame */
        inputs_notice(&notice, &window->inputs, window->viewer, SECOND_TOOL);
        ui_same_line();
        ui_chip(((ui_colour){LOOK_RGB(LOOK_SECOND), 255}));
        if (notice.text) {
            snprintf(text, sizeof text, "%s%s", notice.is_old ? "OLD ANSWER: " : "", notice.text);
            ui_text_wrapped(notice.is_trouble ? THEME_ORANGE : THEME_PLAIN, text);
        }
        ui_dim(notice.is_old ? theme_pale : 1);
        panel_lists(window, SECOND_TOOL, 8);
        ui_dim_end();
        choose_settings(window);
    }
    ui_id_end();
}
