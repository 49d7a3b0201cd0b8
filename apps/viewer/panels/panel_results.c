/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of results and the one of confirmed results. */
#include "viewer/panels/panels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void draw_number(const char *format, double value)
{
    ui_cell();
    if (isfinite(value)) {
        ui_text_number(format, value);
    } else {
        ui_text("-");
    }
}

/* The share is there already. */
static bool shows_score(const struct viewer *viewer)
{
    return viewer->cone.options.score && strcmp(viewer->cone.options.score, "share") != 0;
}

/* Of the name: where it was hit. */
static void draw_tip(const conus_result *result)
{
    char tip[128];
    if (result->object && result->pixels) {
        snprintf(tip, sizeof tip, "hit at %.1f, %.1f, %.1f mm, by %u pixels; click: crosshair there",
                 result->contact[0], result->contact[1], result->contact[2], result->pixels);
        ui_tip(tip);
    }
}

static void draw_result(struct window *window, const conus_result *result)
{
    struct viewer *viewer = window->viewer;
    const conus_object *object = conus_atlas_object(viewer->atlas, result->object);
    uint8_t rgb[3];
    viewer_colour(rgb, viewer, result->object);
    const ui_colour colour = {rgb[0], rgb[1], rgb[2], 255};
    ui_id(result->object);
    ui_cell();
    ui_chip("colour", colour);
    ui_same_line();
    if (!object) {
        ui_text("(nothing hit)");
    } else if (ui_row(object->name, viewer->shown.chosen == result->object)) {
        viewer->shown.chosen = result->object;
        if (result->pixels) {
            viewer_cross(viewer, result->contact);
        }
        viewer->version++;
    }
    draw_tip(result);
    ui_cell();
    ui_bar(result->share, 40 * window->scale, colour);
    ui_same_line();
    ui_text("%.1f %%", 100 * result->share);
    if (shows_score(viewer)) {
        draw_number("%.3f", result->score);
    }
    draw_number("%.1f", result->distance);
    if (viewer->cone.options.layers == CONUS_LAYERS_ALL) {
        draw_number("%.1f", result->path);
    }
    ui_id_end();
}

static void draw_results(struct window *window)
{
    const conus_selection *selection = viewer_selection(window->viewer);
    size_t count = conus_selection_count(selection);
    const char *columns[5] = {"area", "share"};
    size_t shown = 2;
    if (shows_score(window->viewer)) {
        columns[shown++] = "score";
    }
    columns[shown++] = "mm";
    if (window->viewer->cone.options.layers == CONUS_LAYERS_ALL) {
        columns[shown++] = "inside";
    }
    if (ui_table("results", columns, shown, 14 * ui_line())) {
        for (size_t i = 0; i < count; i++) {
            draw_result(window, conus_selection_result(selection, i));
        }
        ui_table_end();
    }
}

static void draw_pins(struct window *window)
{
    static const char *const columns[] = {"confirmed", "share", "mm", "apart mm"};
    const struct viewer *viewer = window->viewer;
    if (ui_table("pins", columns, 4, 6 * ui_line())) {
        for (size_t i = viewer->pin_count; i > 0; i--) {
            const struct pin *pin = &viewer->pins[i - 1];
            ui_cell();
            ui_text("%s", pin->name);
            draw_number("%.3f", pin->share);
            draw_number("%.1f", pin->distance);
            draw_number("%.1f", pin->apart);
        }
        ui_table_end();
    }
}

void panel_results(struct window *window)
{
    struct viewer *viewer = window->viewer;
    ui_panel("Hits of the cone", window->right, 0);
    draw_results(window);
    if (ui_button("confirm")) {
        viewer_confirm(viewer);
    }
    ui_tip("or Enter, or a double click on the brain");
    ui_same_line();
    if (ui_button("copy list")) {
        window_copy(window, COPY_RESULTS);
    }
    ui_tip("copies the hits of the cone as a table");
    ui_same_line();
    if (ui_button("copy confirmed")) {
        window_copy(window, COPY_PINS);
    }
    ui_tip("copies what was confirmed as a table");
    if (viewer->pin_count) {
        draw_pins(window);
    }
    panel_cone(window);
    ui_panel_end();
}
