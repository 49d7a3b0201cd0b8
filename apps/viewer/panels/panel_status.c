/* SPDX-License-Identifier: BSD-3-Clause */
/* The status line, and the help over the window. */
#include "viewer/window/window.h"

#include <ctype.h>
#include <math.h>

static void show_place(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const double *given = window->hovers ? window->hovered_at : viewer->crosshair;
    char text[HOVER_TEXT];
    double at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = fabs(given[a]) < 0.05 ? 0 : given[a]; /* no -0.0 */
    }
    window_hover_text(window, text);
    long voxel[3];
    double grey = conus_atlas_value(viewer->atlas, viewer_context(viewer), at);
    ui_text("%s %.1f, %.1f, %.1f mm RAS", window->hovers ? "mouse" : "cross", at[0], at[1], at[2]);
    if (viewer_voxel(voxel, viewer, at)) {
        ui_same_line();
        ui_text("voxel %ld, %ld, %ld", voxel[0], voxel[1], voxel[2]);
    }
    if (isfinite(grey)) {
        ui_same_line();
        ui_text("grey %.4g", grey);
    }
    ui_same_line();
    ui_text("%s", text);
}

static void show_times(const struct window *window)
{
    char device[160] = "";
    const struct viewer *viewer = window->viewer;
    if (viewer->painter) {
        painter_device(viewer->painter, device, sizeof device);
    }
    ui_same_line();
    ui_text("  |  frame %.1f ms, picture %.0f ms, selection %.3f ms  |  %s", window->frame_ms, window->painted_ms,
            viewer->select_ms, device);
}

void panel_status(struct window *window)
{
    ui_panel("status", window->status, UI_PLAIN);
    ui_indent();
    show_place(window);
    if (!window->quiet_status) {
        show_times(window);
    }
    ui_same_line();
    ui_text_coloured((ui_colour){255, 200, 90, 255}, "  %s", window->viewer->message);
    ui_unindent();
    ui_panel_end();
}

/* Letters as on the keyboard: an l looks like an I. */
static void show_key(const char *key)
{
    int first = key[1] ? key[0] : toupper((unsigned char)key[0]);
    ui_text_coloured((ui_colour){255, 200, 90, 255}, "%c%s", first, key + 1);
}

void panel_help(struct window *window)
{
    const char *key;
    const char *meaning;
    float width = 520 * window->scale;
    float height = 640 * window->scale;
    ui_panel("Keys and mouse (? closes this)",
             (struct ui_box){((float)window->width - width) / 2, ((float)window->height - height) / 2, width, height},
             UI_IN_FRONT);
    for (size_t i = 0; keys_describe(i, &key, &meaning); i++) {
        show_key(key);
        ui_same_line_at(80 * window->scale);
        ui_text_wrapped(meaning);
    }
    ui_separator();
    ui_text_wrapped(
        "3-D: left button turns, right button moves, wheel comes nearer, a click sets the crosshair, a double click "
        "confirms; where the mouse points, the cone follows it from your eye.\n"
        "Flat panes: left button sets the crosshair, wheel goes through the cuts, Ctrl and wheel magnify; with "
        "the wand, right button puts the device there, with Shift it points there.");
    ui_panel_end();
}
