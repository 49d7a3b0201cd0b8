/* SPDX-License-Identifier: BSD-3-Clause */
/* What of the cone counts, as what areas are reported, and the order of the lists. */
#include "viewer/panes/panels.h"

#include "viewer/model/question.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEVELS_SHOWN = 24 };

static const double deepest_mm = 300;
static const double least_mm = 0.1; /* between the limits */

static void choose_range(struct viewer *viewer)
{
    double from = viewer->cone.options.range[0];
    double to = viewer->cone.options.range[1];
    bool limited = to > 0;
    if (viewer->cone.options.sampling == CONUS_SAMPLING_SLICES) {
        ui_text("depth limits need exact sampling");
        return;
    }
    if (ui_check("only some depths", &limited)) {
        (void)(limited ? question_move_range(viewer, 0, 0) : question_set_range(viewer, 0, 0));
        return;
    }
    ui_tip("only what lies between two depths along the axis, mm from the apex, counts (--range);\n"
           "F4 and F5 move the farther limit, F2 and F3 the nearer one");
    if (!limited) {
        return;
    }
    bool changed = ui_slider("from depth", &from, 0, deepest_mm, "%.1f mm", true);
    ui_tip("mm along the axis from the apex: nothing before it counts");
    changed = ui_slider("to depth", &to, least_mm, deepest_mm, "%.1f mm", true) || changed;
    ui_tip("mm along the axis from the apex: nothing behind it counts");
    if (changed) {
        from = fmin(from, fmax(to - least_mm, 0));
        question_set_range(viewer, from, to);
    }
}

static void choose_depth(struct viewer *viewer, unsigned deepest)
{
    static const char *const names[LEVELS_SHOWN + 1] = {
        "each area", "1, the roots", "2",  "3",  "4",  "5",  "6",  "7",  "8",  "9",  "10", "11", "12",
        "13",        "14",           "15", "16", "17", "18", "19", "20", "21", "22", "23", "24"};
    bool listed = viewer->cone.level[0] && !question_depth(viewer);
    size_t depth = listed ? SIZE_MAX : question_depth(viewer);
    char level[32] = "";
    if (ui_choose("level", &depth, names, 1 + (deepest < LEVELS_SHOWN ? deepest : LEVELS_SHOWN))) {
        if (depth) {
            snprintf(level, sizeof level, "%zu", depth);
        }
        question_set_level(viewer, level);
    }
    ui_tip("areas are reported as the areas that they are part of, at this depth of the tree (--level); F7: the next\n"
           "one. The roots are 1. It holds for the first atlas.");
}

/* A list of areas; what is typed holds from Enter on. */
static void type_level(struct viewer *viewer)
{
    char typed[LEVEL_LIMIT] = ""; /* the widget keeps what is being typed */
    if (!question_depth(viewer)) {
        memcpy(typed, viewer->cone.level, sizeof typed);
    }
    ui_type("areas", typed, sizeof typed, "Thalamus,Isocortex");
    bool entered = ui_entered();
    ui_tip("areas are reported as the nearest of these that they are part of; names with commas between, then Enter");
    if (entered) {
        question_set_level(viewer, typed);
    }
}

static void choose_order(struct window *window)
{
    static const char *const orders[] = {"the best first", "the nearest first"};
    size_t order = window->viewer->cone.order;
    if (ui_choose("list", &order, orders, 2)) {
        property_set(window, PROPERTY_ORDER, (double)order);
    }
    panel_tip(PROPERTY_ORDER);
}

void panel_question(struct window *window)
{
    struct viewer *viewer = window->viewer;
    unsigned deepest = question_deepest(viewer);
    choose_range(viewer);
    if (deepest) {
        choose_depth(viewer, deepest);
        type_level(viewer);
    }
    choose_order(window);
}
