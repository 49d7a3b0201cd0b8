/* SPDX-License-Identifier: BSD-3-Clause */
/* The status line. */
#include "viewer/panels/panels.h"

#include "viewer/window/hover.h"

#include <math.h>

static void show_place(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const double *at = window->hover.has_place ? window->hover.at : viewer->crosshair;
    char text[HOVER_TEXT];
    char place[VIEWER_PLACE_TEXT];
    hover_text(text, window, "; ");
    long voxel[3];
    double grey = conus_atlas_value(viewer->drawn->atlas, view_atlas_context(viewer->drawn), at);
    ui_text("%s %s", window->hover.has_place ? "mouse" : "cross", viewer_place_text(place, viewer, at));
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
            viewer->cone.select_ms, device);
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
