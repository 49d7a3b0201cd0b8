/* SPDX-License-Identifier: BSD-3-Clause */
/* The card of the chosen area: facts about it, and buttons that act on it. */
#include "options/output.h"
#include "viewer/model/viewer.h"
#include "viewer/panes/panes.h"
#include "viewer/ui/ui.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TREE_TEXT = 512, DEEPEST = 32 };

static void draw_fact(const char *name, const char *value)
{
    ui_text_coloured(THEME_HINT, "%s", name);
    ui_same_line_at(0.36F * ui_room());
    ui_name_cut(value, ui_room());
}

/* "Brain > Cortex > Insula": the areas that it is part of, and itself. */
static void write_tree(char out[TREE_TEXT], const conus_atlas *atlas, uint32_t number)
{
    uint32_t line[DEEPEST];
    size_t count = 0;
    size_t used = 0;
    while (number && count < DEEPEST) {
        line[count++] = number;
        number = conus_atlas_object(atlas, number)->parent;
    }
    out[0] = '\0';
    while (count && used < TREE_TEXT) {
        const char *name = conus_atlas_object(atlas, line[--count])->name;
        used += (size_t)snprintf(out + used, TREE_TEXT - used, "%s%s", used ? " > " : "", name);
    }
}

static void draw_facts(struct viewer *viewer, const conus_object *object, uint32_t number)
{
    const struct view_atlas *view = viewer->drawn;
    char text[TREE_TEXT];
    const char side = view_atlas_side(view, number); /* that the table or the name gives */
    ui_text_wrapped(THEME_ACCENT, object->name);
    if (!ui_can_write(object->name)) {
        ui_text_wrapped(
            THEME_PLAIN,
            "? stands for letters that this window's font does not have. Copied and exported lists have them.");
    }
    if (object->abbreviation[0] && strcmp(object->abbreviation, object->name) != 0) {
        draw_fact("Abbreviation", object->abbreviation);
    }
    snprintf(text, sizeof text, "%u", object->label);
    draw_fact("Label", text);
    if (object->volume_mm3 > 0) {
        snprintf(text, sizeof text, "%.2f cm\u00b3 (%.0f mm\u00b3)", object->volume_mm3 / 1000, object->volume_mm3);
        draw_fact("Volume", text);
    }
    if (side == 'L' || side == 'R' || side == 'B') {
        draw_fact("Side", side == 'L' ? "left" : side == 'R' ? "right" : "both");
    }
    if (object->parent) {
        write_tree(text, view->atlas, number);
        draw_fact("Part of", text);
    }
    const char *name = view->name[0] ? view->name : path_name(view->path);
    snprintf(text, sizeof text, "%.200s%s", name, object->named ? "" : ", which does not name it");
    draw_fact("Atlas", text);
}

/* Makes and ends what the plan asks of the area. */
static void draw_asked(struct window *window, uint32_t number, const char *name)
{
    static const struct {
        conus_constraint_kind kind;
        const char *labels[2], *tips[2]; /* [whether it is asked] */
    } rows[] = {
        {CONUS_CONSTRAINT_REACH,
         {"Set as target", "No target"},
         {"the needle of the plan is to reach it (--reach), in place of what it was to reach; F5 sets how deep the "
          "needle goes",
          "the needle of the plan need not reach it any more"}},
        {CONUS_CONSTRAINT_AVOID,
         {"Avoid", "Avoid no more"},
         {"the needle of the plan may not touch it (--avoid), nor what it was to avoid before",
          "the needle of the plan may touch it again"}}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const bool is = plans_asks(window->viewer, rows[i].kind, number);
        ui_flow(rows[i].labels[is]);
        if (ui_button(rows[i].labels[is], rows[i].tips[is])) {
            window_request_asked(window, rows[i].kind, name, !is);
        }
    }
}

void panel_card(struct window *window)
{
    struct viewer *viewer = window->viewer;
    uint32_t number = viewer->drawn->shown.chosen;
    const conus_object *object = conus_atlas_object(viewer->drawn->atlas, number);
    if (!object) {
        ui_text_wrapped(THEME_HINT, "no area is chosen: click one in a picture or a list");
        return;
    }
    ui_id(number);
    draw_facts(viewer, object, number);
    panel_hide(viewer, number, false);
    ui_flow("Keep");
    if (ui_button("Keep", "adds it to what was kept, with the place of the crosshair")) {
        const double *at = viewer->crosshair;
        viewer_pin(viewer, (struct pin){.atlas = (size_t)(viewer->drawn - viewer->atlases),
                                        .object = number,
                                        .share = NAN,
                                        .distance = NAN,
                                        .contact = {at[0], at[1], at[2]}});
        viewer->version++;
    }
    if (viewer->drawn == viewer->atlases) { /* which plans are about */
        draw_asked(window, number, object->name);
    }
    panel_look_area(viewer, number);
    ui_id_end();
}
