/* SPDX-License-Identifier: BSD-3-Clause */
/* The panel of the answer: the table of results, what is asked, and tabs of all else. */
#include "base/look.h"
#include "viewer/panes/panes.h"

#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"
#include "viewer/ui/ui.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>

enum { LEAST_LINES = 4 /* of the list */, MOST_BELOW = 30 /* lines of all below the answer */ };

static const float answer_part = 0.42F; /* of the panel's height, or more where the rest would stay empty */

static void draw_pins(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const char *columns[5] = {"kept", "share", "mm", "from last mm", "atlas"};
    if (!viewer->pin_count) {
        ui_text_wrapped(THEME_HINT,
                        "nothing yet: Keep answer, Enter, or a double click on the brain keeps the first hit");
        return;
    }
    static const char *const widest[5] = {"", "100.00 %", "1000.0", "1000.0", "an atlas's name"};
    float widths[5];
    panel_widths(widths, window, columns, widest, 5);
    bool several = viewer->atlas_count > 1;
    size_t shown = several ? ui_list_fit(widths, 5, 5) : ui_list_fit(widths, 4, 2); /* the copied table has all */
    if (ui_table("pins", columns, widths, shown, fmaxf(ui_room_below(), 4 * ui_list_line()))) {
        for (size_t i = viewer->pin_count; i > 0; i--) {
            const struct pin *pin = &viewer->pins[i - 1];
            char title[VIEW_ATLAS_TITLE];
            ui_cell();
            ui_name_cut(viewer_pin_title(title, viewer, pin), ui_room());
            ui_cell();
            panel_number("%.1f %%", 100 * pin->share);
            for (size_t c = 2; c < shown && c < 4; c++) {
                ui_cell();
                panel_number("%.1f", c == 2 ? pin->distance : pin->apart);
            }
            if (several) {
                ui_cell();
                ui_name_cut(viewer->names[pin->atlas], ui_room());
            }
        }
        ui_list_end();
    }
}

static void offer(struct window *window, const char *label, const char *key, const char *tip)
{
    if (ui_button(label, tip)) {
        window_press(window, key);
        ui_popup_close();
    }
}

/* Draws the ways in which the answer leaves the window. */
static void draw_ways_out(struct window *window)
{
    struct viewer *viewer = window->viewer;
    if (!ui_popup("Save\u2026")) {
        ui_tip("the answer as a file, or copied as a table");
        return;
    }
    offer(window, "Export", "ctrl+e",
          "writes the hits of the cone with all columns as conus query does, and a sidecar (Ctrl+E)");
    ui_same_line();
    ui_width(80 * window->screen.scale);
    if (ui_choose("##format", &viewer->list.format, result_formats, RESULT_FORMATS, "the format of exported files")) {
        viewer->version++;
    }
    offer(window, "Copy list", "ctrl+c", "copies the hits of the cone as a table (Ctrl+C)");
    offer(window, "Copy kept", "ctrl+shift+c", "copies what was kept as a table (Ctrl+Shift+C)");
    ui_popup_end();
}

/* Draws the main button, which keeps what the large letters say: the first hit, or the needle of a plan. */
static void draw_keep(struct window *window, const struct headline *headline, bool is_old)
{
    struct viewer *viewer = window->viewer;
    const conus_selection *selection = viewer_selection(viewer);
    const conus_result *best = conus_selection_count(selection) ? conus_selection_result(selection, 0) : NULL;
    bool can = (headline->is_of_plan || (best && best->object)) && !is_old;
    bool (*button)(const char *label, const char *tip) = can ? ui_main_button : ui_button; /* without one it is grey */
    ui_disable(!can);
    bool pressed =
        headline->is_of_plan
            ? button("Keep this needle", "keeps it in a list, with both ends; or Enter, or a double click on the brain")
            : button("Keep answer", "keeps the first hit in a list; or Enter, or a double click on the brain");
    ui_disable_end();
    if (pressed) {
        inputs_confirm(&window->inputs, viewer, FIRST_TOOL);
    }
}

static void draw_buttons(struct window *window, const struct headline *headline, bool is_old)
{
    draw_keep(window, headline, is_old);
    ui_flow("Save\u2026");
    draw_ways_out(window);
    ui_flow("Figure\u2026");
    panel_key_button(window, "Figure\u2026", "ctrl+p", "saves 3-D or a cut at any size (Ctrl+P)");
}

/* Draws what the panel is about, and at its right what changes the list and folds the panel. */
static void draw_title(struct window *window)
{
    float start = ui_room() - ui_button_width("Columns") - ui_button_width("\u00bb");
    bool all = window->viewer->cone.options.layers == CONUS_LAYERS_ALL && !window->viewer->cone.one_ray;
    const conus_drawn_point *point = points_chosen(window->viewer);
    char title[128];
    snprintf(title, sizeof title, "%s%s%s the %s", point ? point->name : "", point ? ": " : "",
             window->viewer->tools[FIRST_TOOL].is_point ? "what is at"
             : all                                      ? "all depths of"
                                                        : "first hits of",
             viewer_shape(window->viewer));
    title[0] = point ? title[0] : (char)toupper((unsigned char)title[0]);
    ui_tint(THEME_HINT);
    ui_text_cut(title, start);
    ui_tint_end();
    ui_same_line_at(start + (LOOK_PADDING_X + LOOK_GAP_X) * window->screen.scale);
    panel_columns(window);
    ui_same_line();
    if (ui_button("\u00bb", "folds this panel to its rail")) {
        layout_fold(&window->screen.layout, 1, true);
    }
}

/* What holds of the answer, above it. */
static void draw_notices(struct window *window, const struct notice *notice)
{
    struct viewer *viewer = window->viewer;
    const double *range = viewer->cone.options.range;
    char depths[80];
    if (notice->is_old) {
        ui_tint(THEME_ORANGE);
        ui_heading("OLD ANSWER");
        ui_tint_end();
    }
    if (notice->is_old ||
        (notice->is_trouble && !screen_shows_pane(&window->screen, PANE_3D))) { /* which says it, too */
        ui_text_wrapped(THEME_ORANGE, notice->text);
    }
    if (range[1] > 0) { /* the limits of the lists, whose widgets may be scrolled out of sight below */
        snprintf(depths, sizeof depths, "only depths from %.6g to %.6g mm count", range[0], range[1]);
        ui_text_wrapped(THEME_ACCENT, depths);
    }
    if (viewer->cone.level[0]) {
        ui_text_coloured(THEME_ACCENT, "level: %s", viewer->cone.level);
    }
    panel_hidden(window);
    panel_warnings(viewer);
}

/* The answer has its part of the panel's height, whatever it says: all below it stays where it is. */
static void draw_all_of_answer(struct window *window, const struct notice *notice, const struct headline *headline)
{
    const float rest = fminf((1 - answer_part) * ui_room_below(), MOST_BELOW * ui_line());
    draw_title(window);
    draw_notices(window, notice);
    ui_dim(notice->is_old ? theme_pale : 1);
    ui_heading(headline->what); /* two lines, which are there without a hit, too: nothing moves then */
    ui_text_wrapped(THEME_HINT, headline->more);
    panel_plan(window);
    panel_lists(window, FIRST_TOOL, fmaxf(floorf((ui_room_below() - rest) / ui_list_line()), LEAST_LINES));
    window_note_shown(window, SHOWN_LIST);
    ui_dim_end();
    ui_gap(fmaxf(ui_room_below() - rest, 0));
}

static void draw_sureness(struct window *window)
{
    struct notice notice;
    inputs_notice(&notice, &window->inputs, window->viewer, FIRST_TOOL);
    panel_property(window, PROPERTY_STUDY);
    panel_study(window, notice.is_old);
}

static unsigned plan_number(const struct viewer *viewer)
{
    return plans_is_on(viewer) ? viewer->plan.number : 0;
}

static unsigned study_number(const struct viewer *viewer)
{
    return viewer->study.settings.kind;
}

static unsigned point_number(const struct viewer *viewer)
{
    return viewer->points.count ? viewer->points.number : 0;
}

static unsigned second_number(const struct viewer *viewer)
{
    return viewer->tools[SECOND_TOOL].on;
}

/* What lies below the question, one at a time. A number that changes, but to 0, brings its tab to the front. */
static const struct {
    const char *label, *tip;
    void (*draw)(struct window *window);
    unsigned (*number)(const struct viewer *viewer);
} tabs[PANEL_TABS] = {
    {"Area", "the chosen area: facts, and what can be done with it", panel_card, NULL},
    {"Kept", "the answers that were kept", draw_pins, NULL},
    {"Points", "the list of contacts, optodes or coils, of which one is asked about", panel_points, point_number},
    {"How sure?", "the answer at other openings, or of a pose that is not exactly known (J)", draw_sureness,
     study_number},
    {"Plan", "the needles of the plan, the best first", panel_planned, plan_number},
    {"Look", "how brain, areas and image are drawn", panel_look, NULL},
    {"Expert", "all other settings of the question", panel_expert, NULL},
    {"2nd tool", "another cone, of another device, with a list of its own (2)", panel_second, second_number},
};

static void draw_tabs(struct window *window)
{
    struct panel_tabs *shown = &window->screen.tabs;
    ui_separator();
    for (size_t i = 0; i < PANEL_TABS; i++) {
        char label[32];
        if (tabs[i].draw == panel_points && !window->viewer->points.count) {
            shown->shown = shown->shown == i ? 0 : shown->shown;
            continue;
        }
        unsigned number = tabs[i].number ? tabs[i].number(window->viewer) : 0;
        shown->shown = number && number != shown->numbers[i] ? i : shown->shown;
        shown->numbers[i] = number;
        snprintf(label, sizeof label, i == 1 && window->viewer->pin_count ? "%s %zu" : "%s", tabs[i].label,
                 window->viewer->pin_count);
        if (i) {
            ui_flow(label);
        }
        shown->shown = ui_tab(label, shown->shown == i, tabs[i].tip) ? i : shown->shown;
    }
    ui_scroll("tab", fmaxf(ui_room_below(), 8 * ui_line()));
    for (size_t i = PANEL_TABS; i--;) {
        if (ui_shows_tab(shown->shown == i)) {
            tabs[i].draw(window);
        }
    }
    ui_scroll_end();
}

void panel_results(struct window *window)
{
    struct viewer *viewer = window->viewer;
    struct notice notice;
    struct headline headline;
    if (window->screen.folded[1]) {
        panel_rail(window, 1);
        return;
    }
    inputs_notice(&notice, &window->inputs, viewer, FIRST_TOOL);
    headline_find(&headline, viewer);
    ui_panel("Hits of the cone", window->screen.right, UI_UNTITLED);
    draw_all_of_answer(window, &notice, &headline);
    draw_buttons(window, &headline, notice.is_old);
    panel_question(window);
    draw_tabs(window);
    ui_panel_end();
}
