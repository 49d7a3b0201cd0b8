/* SPDX-License-Identifier: BSD-3-Clause */
/* The status line. */
#include "viewer/panes/panes.h"

#include "viewer/ui/ui.h"
#include "viewer/window/window.h"

#include <math.h>
#include <stdio.h>

enum { STATUS_TEXT = HOVER_TEXT + 256 };

static const float gap = 16; /* pixels at scale 1, between the parts of the line */

/* Word and colour of the lamp, by the tracker's state. */
static const char *const lamp_words[] = {"no data", "no data", "lost", "lost", "tracking"};
static const enum theme_text lamp_colours[] = {THEME_HINT, THEME_HINT, THEME_RED, THEME_RED, THEME_GREEN};

static void write_place(char out[STATUS_TEXT], const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const double *at = window->frame.hover.has_place ? window->frame.hover.at : viewer->crosshair;
    char text[HOVER_TEXT];
    char place[VIEWER_PLACE_TEXT];
    char voxel_text[80] = "";
    char grey_text[32] = "";
    long voxel[3];
    double grey = conus_atlas_value(viewer->drawn->atlas, view_atlas_context(viewer->drawn), at);
    hover_text(text, window, "; ");
    if (viewer_voxel(voxel, viewer, at)) {
        snprintf(voxel_text, sizeof voxel_text, "  voxel %ld, %ld, %ld", voxel[0], voxel[1], voxel[2]);
    }
    if (isfinite(grey)) {
        snprintf(grey_text, sizeof grey_text, "  grey %.4g", grey);
    }
    snprintf(out, STATUS_TEXT, "%s %s%s%s  %s", window->frame.hover.has_place ? "mouse" : "cross",
             viewer_place_text(place, viewer, at), voxel_text, grey_text, text);
}

/* The last message is whole where it can be; the place gets the rest. */
void panel_status(struct window *window)
{
    char place[STATUS_TEXT];
    const char *message = window->viewer->message;
    float wide = window->screen.status.width - 2 * gap * window->screen.scale;
    float said = fminf(message[0] ? ui_text_width(message) + gap * window->screen.scale : 0, 0.7F * wide);
    enum station_state state = window->inputs.update.state;
    bool tracked = window->viewer->tools[FIRST_TOOL].pointer == POINT_BY_TRACKER;
    const char *lamp = !tracked ? NULL : window->inputs.station ? lamp_words[state] : "no tracker";
    float lit = lamp ? ui_text_width(lamp) + 3.5F * gap * window->screen.scale : 0;
    wide -= lit;
    write_place(place, window);
    window_note_shown(window, SHOWN_STATUS);
    float placed = fminf(ui_text_width(place), wide - said);
    ui_panel("status", window->screen.status, UI_PLAIN);
    ui_gap(0);
    ui_same_line_at(gap * window->screen.scale);
    if (lamp) {
        ui_chip(theme_texts[lamp_colours[state]]);
        ui_same_line_at(2.5F * gap * window->screen.scale);
        ui_text("%s", lamp);
        ui_same_line_at(lit);
    }
    ui_text_cut(place, placed);
    if (message[0]) {
        ui_same_line_at(gap * window->screen.scale + lit + placed + gap * window->screen.scale);
        ui_tint(THEME_ACCENT);
        ui_text_cut(message, said - gap * window->screen.scale);
        ui_tint_end();
    }
    ui_panel_end();
}
