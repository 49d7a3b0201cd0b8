/* SPDX-License-Identifier: BSD-3-Clause */
/* The verdict of a plan's constraints on the first tool, and the list of poses that it has planned. */
#include "viewer/panes/panes.h"

#include "viewer/ui/ui.h"

#include <math.h>
#include <stdio.h>

enum { COLUMNS = 4, LINES = 7 };

static const struct {
    const char *heading, *tip, *widest;
} columns[COLUMNS] = {
    {"pose", "the planned poses, the best first; click, or ; and :, move the first tool there and hold it",
     "12  entry 12"},
    {"spare mm", "mm by which no point of the needle may be off before a constraint breaks", "88.88"},
    {"away mm", "mm between the needle and what it is to avoid", "888.88"},
    {"from", "what of that is nearest; of the nearest misses the constraint that they break", "Hippocampus_L"},
};

static void draw_row(struct viewer *viewer, const struct plan_row *row, size_t index, size_t shown, bool is_here)
{
    char place[VIEWER_PLACE_TEXT];
    char number[PLAN_NUMBER];
    char title[PLAN_ID + 32];
    char tip[PLAN_ID + VIEWER_PLACE_TEXT + 64];
    const double *m = row->pose.world_from_device;
    const double tip_at[3] = {m[12] - row->range[1] * m[8], m[13] - row->range[1] * m[9],
                              m[14] - row->range[1] * m[10]};
    snprintf(title, sizeof title, "%zu  %s", index + 1, row->id);
    snprintf(tip, sizeof tip, "%.1f mm deep, its tip at %s\nclick: the first tool goes there and is held",
             row->range[1], viewer_place_text(place, viewer, tip_at));
    if (ui_row_cut(title, is_here, tip)) {
        plans_go(viewer, index);
    }
    for (size_t i = 1; i < shown; i++) {
        ui_cell();
        if (i < COLUMNS - 1) {
            ui_text_right(plans_number(number, i == 1 ? row->leeway : row->clearance));
        } else {
            ui_name_cut(row->nearest, ui_room());
        }
    }
}

static void draw_list(struct viewer *viewer, const struct plan_list *list)
{
    float widths[COLUMNS];
    size_t here = plans_at(viewer);
    for (size_t i = 0; i < COLUMNS; i++) {
        widths[i] = fmaxf(ui_text_width(columns[i].widest), ui_text_width(columns[i].heading));
    }
    size_t shown = ui_list_fit(widths, COLUMNS, 2);
    if (ui_list("plan", widths, shown, fminf(LINES, (float)list->count + 2) * ui_list_line())) {
        ui_list_top();
        for (size_t i = 0; i < shown; i++) {
            ui_id((uint32_t)i);
            ui_list_heading(columns[i].heading, i == 1 || i == 2);
            ui_tip(columns[i].tip);
            ui_id_end();
        }
        for (size_t i = 0; i < list->count; i++) {
            if (ui_list_row()) {
                ui_id((uint32_t)i);
                draw_row(viewer, &list->rows[i], i, shown, i == here);
                ui_id_end();
            }
        }
        ui_list_end();
    }
}

void panel_plan(struct window *window)
{
    struct viewer *viewer = window->viewer;
    char line[PLAN_LINE];
    if (!plans_is_on(viewer)) {
        return;
    }
    const struct plan_verdict *verdict = plans_verdict(viewer);
    plans_line(line, viewer, true);
    ui_text_wrapped(panel_verdict_colour(verdict), line);
    ui_tip(verdict->details[0] ? verdict->details : "what the constraints of the plan say of the first tool");
    if (verdict->lost) { /* by another atlas, other hemispheres, or since it is hidden */
        const bool is_avoid = verdict->lost->kind == CONUS_CONSTRAINT_AVOID;
        if (ui_button(is_avoid ? "Avoid it no more" : "No target",
                      "the plan goes on without this; until then, or until "
                      "the atlas shows it again, nothing is judged")) {
            window_request_asked(window, verdict->lost->kind, verdict->lost->names, false);
        }
    }
}

void panel_planned(struct window *window)
{
    struct viewer *viewer = window->viewer;
    const char *why;
    const struct plan_list *list = plans_list(viewer, &why);
    bool is_behind = plans_is_on(viewer) && plans_is_behind(viewer);
    ui_text_wrapped(is_behind ? THEME_ORANGE : THEME_HINT, is_behind && list ? "OLD: trying the poses anew"
                                                           : list            ? list->says
                                                                             : why);
    ui_dim(is_behind ? theme_pale : 1);
    if (list && list->count) {
        draw_list(viewer, list);
    }
    ui_dim_end();
}
