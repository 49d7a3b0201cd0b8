/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of results and the one of confirmed results. */
#include "viewer/panels/panels.h"

#include "viewer/hands/hands.h"

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

static bool shows_path(const struct viewer *viewer)
{
    return viewer->cone.options.layers == CONUS_LAYERS_ALL && !viewer->cone.one_ray;
}

/* Of the name: where it was hit. */
static void draw_tip(const struct viewer *viewer, const conus_result *result)
{
    char tip[192];
    char place[VIEWER_PLACE_TEXT];
    if (result->object && result->pixels) {
        snprintf(tip, sizeof tip, "hit at %s, by %u pixels; click: crosshair there",
                 viewer_place_text(place, viewer, result->contact), result->pixels);
        ui_tip(tip);
    }
}

/* Colours are those of the pictures: an atlas that is not in them has none. */
static ui_colour colour_of(const struct viewer *viewer, const struct view_atlas *on, uint32_t object)
{
    static const ui_colour grey = {130, 132, 138, 255};
    uint8_t rgb[3];
    viewer_colour(rgb, viewer, object);
    return on == viewer->drawn ? (ui_colour){rgb[0], rgb[1], rgb[2], 255} : grey;
}

/* Only what is drawn can be chosen; wherever it is, the crosshair goes there. */
static void click(struct viewer *viewer, const struct view_atlas *on, const conus_result *result)
{
    if (on == viewer->drawn) {
        viewer->drawn->shown.chosen = result->object;
    }
    if (result->pixels) {
        viewer_cross(viewer, result->contact);
    }
    viewer->version++;
}

static void draw_result(struct window *window, const struct view_atlas *on, const conus_result *result)
{
    struct viewer *viewer = window->viewer;
    const conus_object *object = conus_atlas_object(on->atlas, result->object);
    const ui_colour colour = colour_of(viewer, on, result->object);
    ui_id(result->object);
    ui_cell();
    if (on == viewer->drawn) {
        ui_chip("colour", colour);
        ui_same_line();
    }
    if (!object) {
        ui_text("(nothing hit)");
    } else if (ui_row(object->name, on == viewer->drawn && on->shown.chosen == result->object)) {
        click(viewer, on, result);
    }
    draw_tip(viewer, result);
    ui_cell();
    ui_bar(result->share, 40 * window->scale, colour);
    ui_same_line();
    ui_text("%.1f %%", 100 * result->share);
    if (shows_score(viewer)) {
        draw_number("%.3f", result->score);
    }
    draw_number("%.1f", result->distance);
    if (shows_path(viewer)) {
        draw_number("%.1f", result->path);
    }
    ui_id_end();
}

void panel_list(struct window *window, const struct view_atlas *on, const conus_selection *selection, float lines)
{
    size_t count = conus_selection_count(selection);
    const char *columns[5] = {"area", "share"};
    size_t shown = 2;
    if (shows_score(window->viewer)) {
        columns[shown++] = "score";
    }
    columns[shown++] = "mm";
    if (shows_path(window->viewer)) {
        columns[shown++] = "inside";
    }
    if (ui_table("results", columns, shown, lines * ui_line())) {
        for (size_t i = 0; i < count; i++) {
            draw_result(window, on, conus_selection_result(selection, i));
        }
        ui_table_end();
    }
}

/* Each under its name, in the order in which they were given. */
static void draw_all_results(struct window *window)
{
    struct viewer *viewer = window->viewer;
    float lines = fmaxf((window->second.on ? 8.0F : 16.0F) / (float)viewer->atlas_count, 5);
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        const struct view_atlas *on = &viewer->atlases[i];
        ui_id((uint32_t)i);
        ui_text_coloured((ui_colour){255, 200, 90, 255}, "%s", on->name);
        ui_same_line();
        if (on == viewer->drawn) {
            ui_text("drawn");
        } else {
            bool next = ui_small_button("draw");
            ui_tip("shows this atlas in the pictures and the list of areas; N: the next one");
            if (next) {
                viewer_draw(viewer, i);
            }
        }
        panel_list(window, on, view_atlas_selection(on), lines);
        ui_id_end();
    }
}

static void draw_pins(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const char *columns[5] = {"confirmed", "share", "mm", "apart mm", "atlas"};
    bool several = viewer->atlas_count > 1;
    if (ui_table("pins", columns, several ? 5 : 4, 6 * ui_line())) {
        for (size_t i = viewer->pin_count; i > 0; i--) {
            const struct pin *pin = &viewer->pins[i - 1];
            ui_cell();
            ui_text("%s", pin->name);
            draw_number("%.3f", pin->share);
            draw_number("%.1f", pin->distance);
            draw_number("%.1f", pin->apart);
            if (several) {
                ui_cell();
                ui_text("%s", viewer->names[pin->atlas]);
            }
        }
        ui_table_end();
    }
}

void panel_results(struct window *window)
{
    struct viewer *viewer = window->viewer;
    struct notice notice;
    hands_notice(&notice, window, FIRST_HAND);
    ui_panel("Hits of the cone", window->right, 0);
    if (notice.is_old) { /* what follows is pale */
        ui_text_coloured((ui_colour){255, 150, 30, 255}, "%s", notice.text);
    }
    ui_dim(notice.is_old ? 0.4F : 1);
    if (viewer->atlas_count > 1) {
        draw_all_results(window);
    } else {
        panel_list(window, viewer->drawn, view_atlas_selection(viewer->drawn), window->second.on ? 8 : 14);
    }
    ui_dim_end();
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
    bool two = window->second.on; /* then its list stands below the first one's */
    if (two) {
        panel_second(window);
    }
    panel_cone(window);
    if (!two) {
        panel_second(window);
    }
    ui_panel_end();
}
