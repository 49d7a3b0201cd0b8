/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of results and the one of confirmed results. */
#include "base/look_sizes.h"
#include "viewer/panes/panels.h"

#include "viewer/model/columns.h"
#include "viewer/model/headline.h"
#include "viewer/ui/ui_list.h"

#include <math.h>
#include <stdio.h>

/* Two lines, which are there without a hit, too: nothing moves then. */
static void draw_answer(const struct headline *headline)
{
    ui_heading(headline->what);
    ui_text_wrapped(THEME_HINT, headline->more);
}

static void draw_pins(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const char *columns[5] = {"confirmed", "share", "mm", "apart mm", "atlas"};
    static const char *const widest[5] = {"", "100.00 %", "1000.00", "1000.00", "an atlas's name"};
    float widths[5];
    panel_widths(widths, window, columns, widest, 5);
    bool several = viewer->atlas_count > 1;
    size_t shown = several ? ui_list_fit(widths, 5, 5) : ui_list_fit(widths, 4, 2); /* the copied table has all */
    if (ui_table("pins", columns, widths, shown, 6 * ui_list_line())) {
        for (size_t i = viewer->pin_count; i > 0; i--) {
            const struct pin *pin = &viewer->pins[i - 1];
            char title[VIEW_ATLAS_TITLE];
            ui_cell();
            ui_name_cut(viewer_pin_title(title, viewer, pin), ui_room());
            ui_cell();
            panel_number("%.1f %%", 100 * pin->share);
            for (size_t c = 2; c < shown && c < 4; c++) {
                ui_cell();
                panel_number("%.2f", c == 2 ? pin->distance : pin->apart);
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
    if (ui_choose("##format", &viewer->list.format, result_formats, RESULT_FORMATS)) {
        viewer->version++;
    }
    ui_tip("the format of exported files");
    offer(window, "Copy list", "ctrl+c", "copies the hits of the cone as a table (Ctrl+C)");
    offer(window, "Copy confirmed", "ctrl+shift+c", "copies what was confirmed as a table (Ctrl+Shift+C)");
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
            : button("Keep answer",
                     "confirms the first hit: pins it in a list; or Enter, or a double click on the brain");
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
    char title[64];
    snprintf(title, sizeof title, "%s of the %s", all ? "All depths" : "First hits", viewer_shape(window->viewer));
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

void panel_results(struct window *window)
{
    struct viewer *viewer = window->viewer;
    const double *range = viewer->cone.options.range;
    char depths[80];
    struct notice notice;
    struct headline headline;
    if (window->screen.folded[1]) {
        panel_rail(window, 1);
        return;
    }
    inputs_notice(&notice, &window->inputs, viewer, FIRST_TOOL);
    headline_find(&headline, viewer);
    ui_panel("Hits of the cone", window->screen.right, UI_UNTITLED);
    draw_title(window);
    if (notice.is_old) {
        ui_tint(THEME_ORANGE);
        ui_heading("OLD ANSWER");
        ui_tint_end();
    }
    if (notice.is_old || (notice.is_trouble && !screen_shows_pane(&window->screen, PANE_3D))) { /* which says it, too */
        ui_text_wrapped(THEME_ORANGE, notice.text);
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
    ui_dim(notice.is_old ? theme_pale : 1);
    draw_answer(&headline);
    panel_plan(window);
    bool two = viewer->tools[SECOND_TOOL].on; /* then its list stands below the first one's */
    bool shares_room = two || viewer->study.settings.kind || plans_is_on(viewer);
    float room = ui_room_below() / ui_list_line();
    bool is_short = shares_room || viewer->cone.options.layers != CONUS_LAYERS_ALL; /* few areas are hit first */
    float lines = viewer->atlas_count > 1 ? (two ? 8 : 16) /* else the rest is for what is asked, and the card */
                  : is_short              ? fmaxf(fminf(8, 0.4F * room), 5)
                                          : fmaxf(fminf(14, 0.4F * room), room - 30);
    panel_lists(window, FIRST_TOOL, lines);
    ui_dim_end();
    draw_buttons(window, &headline, notice.is_old);
    if (viewer->pin_count) {
        draw_pins(window);
    }
    panel_study(window, notice.is_old);
    if (two) {
        panel_second(window);
    }
    panel_question(window);
    panel_expert(window);
    if (!two) {
        panel_second(window);
    }
    panel_card(window); /* below what is pressed: it comes and goes */
    ui_panel_end();
}
