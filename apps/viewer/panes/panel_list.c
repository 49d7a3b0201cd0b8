/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of what the cone hits in one atlas, and the choice of its columns. */
#include "viewer/panes/panes.h"

#include "base/look.h"
#include "viewer/model/columns.h"
#include "viewer/ui/ui.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Colours are those of the pictures: an atlas that is not in them has none. What the second tool hits is marked there
 * in the colour of its cone. */
static ui_colour colour_of(const struct viewer *viewer, const struct view_atlas *view, enum tool_number tool,
                           uint32_t object)
{
    bool is_seconds = tool == SECOND_TOOL && object && view == viewer->drawn;
    return is_seconds ? (ui_colour){LOOK_RGB(LOOK_SECOND), 255}
                      : panel_colour(viewer, view == viewer->drawn ? object : 0);
}

/* Beside the entry the coordinates say whose they are: both may be different places. */
static const char *whose(const struct viewer *viewer, size_t column)
{
    return column == RESULT_X && result_is_offered(viewer, RESULT_ENTRY) ? "contact " : "";
}

static void draw_heading(struct viewer *viewer, size_t column)
{
    char text[RESULT_TEXT];
    char meaning[RESULT_TIP];
    char tip[RESULT_TIP + 64];
    bool orders = viewer->list.order == column && (column != RESULT_RANK || viewer->list.reversed);
    snprintf(text, sizeof text, "%s%s%s", whose(viewer, column), result_heading(viewer, column),
             !orders                 ? ""
             : viewer->list.reversed ? " \u2191"
                                     : " \u2193");
    snprintf(tip, sizeof tip, "%s\nclick: order by it, the other way round, by rank",
             result_meaning(meaning, viewer, column));
    ui_id((uint32_t)column);
    bool pressed = ui_list_heading(text, !result_is_text(column));
    ui_tip(tip);
    ui_id_end();
    if (pressed) {
        result_order_by(viewer, column);
    }
}

/* The width of the widest number that a column can have, so that nothing moves while one points. */
static float width_of(const struct window *window, size_t column)
{
    const struct viewer *viewer = window->viewer;
    if (column == RESULT_NAME) {
        return PANEL_NAME * window->screen.scale;
    }
    char heading[RESULT_TEXT];
    bool orders = viewer->list.order == column;
    snprintf(heading, sizeof heading, "%s%s%s", whose(viewer, column), result_heading(viewer, column),
             orders ? " \u2193" : "");
    return fmaxf(ui_text_width(heading), ui_text_width(result_widest(viewer, column)));
}

static void draw_name(struct viewer *viewer, const struct view_atlas *view, enum tool_number tool,
                      const conus_result *result)
{
    char tip[256] = "";
    char title[VIEW_ATLAS_TITLE];
    char place[VIEWER_PLACE_TEXT];
    const conus_object *object = conus_atlas_object(view->atlas, result->object);
    if (!object) {
        ui_name_cut("(nothing hit)", ui_room());
        return;
    }
    int used = snprintf(tip, sizeof tip, "label %u", object->label);
    if (result->pixels) {
        snprintf(tip + used, sizeof tip - (size_t)used, "\nhit at %s, by %u pixels; click: crosshair there",
                 viewer_place_text(place, viewer, result->contact), result->pixels);
    }
    if (view == viewer->drawn) {
        ui_chip(colour_of(viewer, view, tool, result->object));
        ui_same_line();
    }
    if (ui_row_cut(view_atlas_title(title, view, result->object),
                   view == viewer->drawn && view->shown.chosen == result->object, tip)) {
        if (view == viewer->drawn) { /* only what is drawn can be chosen */
            viewer->drawn->shown.chosen = result->object;
        }
        if (result->pixels) {
            viewer_cross(viewer, result->contact);
        }
        viewer->version++;
    }
}

static void draw_cell(const struct viewer *viewer, const struct view_atlas *view, enum tool_number tool, size_t column,
                      const conus_result *result)
{
    char cell[RESULT_TEXT];
    char exact[RESULT_TEXT];
    char meaning[RESULT_TIP];
    char tip[RESULT_TIP + RESULT_TEXT];
    ui_cell();
    if (column == RESULT_SHARE) {
        ui_underline(result->share, colour_of(viewer, view, tool, result->object));
    }
    const char *text = result_cell(cell, viewer, view, column, result);
    if (result_is_text(column)) {
        ui_name_cut(text, ui_room());
    } else {
        ui_text_right(text);
    }
    if (ui_hovered()) {
        snprintf(tip, sizeof tip, "%s\n%s", result_exact(exact, viewer, view, column, result),
                 result_meaning(meaning, viewer, column));
        ui_tip(tip);
    }
}

static void draw_rows(struct viewer *viewer, const struct view_atlas *view, enum tool_number tool, const size_t *shown,
                      size_t columns)
{
    const conus_selection *selection = view_atlas_selection(view, tool);
    size_t count = conus_selection_count(selection);
    size_t *order = result_order(viewer, view, selection);
    for (size_t i = 0; i < count; i++) {
        const conus_result *result = conus_selection_result(selection, order ? order[i] : i);
        bool is_empty = !result->object && !result->pixels && !(result->share > 0); /* no ray went past all areas */
        if (!is_empty && ui_list_row()) {
            ui_id(result->object);
            draw_name(viewer, view, tool, result);
            for (size_t c = 1; c < columns; c++) {
                draw_cell(viewer, view, tool, shown[c], result);
            }
            ui_id_end();
        }
    }
    free(order);
}

static void draw_list(struct window *window, const struct view_atlas *view, enum tool_number tool, float lines)
{
    size_t shown[RESULT_COLUMNS];
    float widths[RESULT_COLUMNS];
    struct viewer *viewer = window->viewer;
    size_t columns = result_shown(shown, viewer);
    float wide = 4 * ui_line(); /* of the list's bar and the cells' margins */
    for (size_t i = 0; i < columns; i++) {
        widths[i] = width_of(window, shown[i]);
        wide += widths[i];
    }
    /* Where nobody chose the columns: places of contacts give way, names are cut, and then all goes but the share. */
    bool usual = !viewer->list.columns;
    while (usual && wide > ui_room() && columns && shown[columns - 1] >= RESULT_X && shown[columns - 1] <= RESULT_Z) {
        columns--;
    }
    columns = usual ? ui_list_fit(widths, columns, 2) : columns;
    if (ui_list("results", widths, columns, lines * ui_list_line())) {
        ui_list_top();
        for (size_t i = 0; i < columns; i++) {
            draw_heading(viewer, shown[i]);
        }
        draw_rows(viewer, view, tool, shown, columns);
        ui_list_end();
    }
}

/* The lines of the list of one of several atlases: one that needs fewer leaves them to the others. */
static float lines_of(const struct viewer *viewer, enum tool_number tool, size_t index, float lines)
{
    const float fair = fmaxf(floorf(lines / (float)viewer->atlas_count) - 1, 4);
    float own = 0, spare = 0, lacking = 0;
    for (size_t i = 0; i < viewer->atlas_count; i++) { /* with the line of headings */
        const float needed = 1 + (float)conus_selection_count(view_atlas_selection(&viewer->atlases[i], tool));
        spare += fmaxf(fair - needed, 0);
        lacking += fmaxf(needed - fair, 0);
        own = i == index ? needed : own;
    }
    return own <= fair ? own : floorf(fair + (own - fair) * fminf(spare / lacking, 1));
}

void panel_lists(struct window *window, enum tool_number tool, float lines)
{
    struct viewer *viewer = window->viewer;
    bool several = viewer->atlas_count > 1;
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        const struct view_atlas *view = &viewer->atlases[i];
        ui_id((uint32_t)i);
        if (several) {
            ui_text_coloured(THEME_ACCENT, "%s", view->name);
        }
        if (several && tool == FIRST_TOOL) {
            ui_same_line();
            if (view == viewer->drawn) {
                ui_text("drawn");
            } else if (ui_small_button("Draw",
                                       "shows this atlas in the pictures and the list of areas; N: the next one")) {
                viewer_draw(viewer, i);
            }
        }
        draw_list(window, view, tool, several ? lines_of(viewer, tool, i, lines) : lines);
        ui_id_end();
    }
}

void panel_columns(struct window *window)
{
    size_t shown[RESULT_COLUMNS];
    bool is_shown[RESULT_COLUMNS] = {false};
    struct viewer *viewer = window->viewer;
    size_t count = result_shown(shown, viewer);
    for (size_t i = 0; i < count; i++) {
        is_shown[shown[i]] = true;
    }
    bool open = ui_popup("Columns");
    if (!open) {
        ui_tip("which columns the list has; a click above a column orders by it");
        return;
    }
    for (size_t i = 0; i < RESULT_COLUMNS; i++) {
        if (i == RESULT_NAME || !result_is_offered(viewer, i)) {
            continue;
        }
        char meaning[RESULT_TIP];
        char label[RESULT_TEXT];
        bool is_place = i >= RESULT_X && i <= RESULT_Z;
        snprintf(label, sizeof label, "%s%s", is_place ? "contact " : "", result_heading(viewer, i));
        if (ui_check(label, &is_shown[i], result_meaning(meaning, viewer, i))) {
            result_show(viewer, i, is_shown[i]);
        }
    }
    if (viewer->list.columns) {
        bool pressed = ui_button("The usual ones", "those that there were before any was chosen");
        if (pressed) {
            result_choose(viewer, NULL, 0);
        }
    }
    ui_popup_end();
}
