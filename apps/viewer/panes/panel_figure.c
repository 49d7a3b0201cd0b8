/* SPDX-License-Identifier: BSD-3-Clause */
/* The form that asks which pane to save as a figure. */
#include "viewer/panes/panes.h"

#include "base/path.h"
#include "viewer/window/window.h"

#include <string.h>

static void choose_size(struct sheet *sheet)
{
    static const char *const units[] = {"pixels", "mm on paper"};
    size_t unit = sheet->in_mm;
    if (ui_choose("Size in", &unit, units, 2, NULL)) {
        sheet->in_mm = unit;
    }
    if (sheet->in_mm) {
        ui_slider("Width", &sheet->mm[0], 1, SHEET_MM_LIMIT, "%.4g mm", true,
                  "mm on paper, 1 to 10000, such as a column's 85; Ctrl and click to type it");
        ui_slider("Height", &sheet->mm[1], 1, SHEET_MM_LIMIT, "%.4g mm", true,
                  "mm on paper, 1 to 10000; Ctrl and click to type it");
    } else {
        ui_count("Width", &sheet->pixels[0], 1, SHEET_SIDE_LIMIT, "pixels, 1 to 16384; Ctrl and click to type it");
        ui_count("Height", &sheet->pixels[1], 1, SHEET_SIDE_LIMIT, "pixels, 1 to 16384; Ctrl and click to type it");
    }
}

static void choose_dpi(struct sheet *sheet)
{
    bool said = sheet->dpi > 0;
    const char *format = said ? "%.4g" : sheet->in_mm ? "300" : "none";
    double dpi = said ? sheet->dpi : 300;
    if (ui_slider("Dots per inch", &dpi, SHEET_DPI_LEAST, 1200, format, true,
                  "pixels per inch, which the file says, with letters of 7 points; Ctrl and click to type it")) {
        sheet->dpi = dpi;
    }
    if (said && ui_small_button("Leave out", NULL)) {
        sheet->dpi = 0;
    }
}

/* Sets the ending of the name, which says the format. */
static void choose_format(struct figure_form *form)
{
    static const char *const formats[] = {"PNG", "SVG", "PDF"}, *const endings[] = {".png", ".svg", ".pdf"};
    enum { FORMATS = sizeof formats / sizeof formats[0] };
    size_t format = 0;
    while (format < FORMATS && !path_ends_in(form->name, endings[format])) {
        format++;
    }
    if (ui_choose("File", &format, formats, FORMATS,
                  "pixels, or shapes and letters that stay sharp at any size: the ending of the name; .exr is typed")) {
        const char *dot = strrchr(form->name, '.');
        const size_t stem = dot && !strchr(dot, '/') ? (size_t)(dot - form->name) : strlen(form->name);
        if (stem + sizeof ".png" <= sizeof form->name) {
            memcpy(form->name + stem, endings[format], sizeof ".png");
        }
    }
}

static void choose_name(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    choose_format(form);
    ui_take_keys(&form->takes_keys);
    bool entered = ui_type(
        "Name", form->name, sizeof form->name, "figure.png",
        "of the file, .png, .svg, .pdf or .exr, in the folder where conus was started, or a whole path; Enter saves");
    if (ui_button("Save figure", NULL) || entered) {
        figure_form_save(window);
    }
    ui_same_line();
    if (ui_button("Preview", "draws it here, as small as there is room")) {
        figure_form_preview(window);
    }
    ui_same_line();
    if (form->saved[0] && ui_button("Copy its path", NULL)) {
        figure_form_copy(window);
    }
    ui_same_line();
    if (ui_button("Close", NULL)) {
        form->open = false;
    }
    ui_text_wrapped(form->failed ? THEME_ORANGE : THEME_PLAIN, form->update);
}

void panel_figure(struct window *window)
{
    static const char *const panes[] = {"axial cut", "coronal cut", "sagittal cut", "3-D"};
    struct sheet before = window->sheet;
    const struct texture *preview = figure_form_previewed(window);
    const float wide = preview ? (float)preview->width : 0, high = preview ? (float)preview->height : 0;
    window_panel(window, "Save a figure (Ctrl+P; Escape closes this)", 520,
                 (plans_is_on(window->viewer) ? 387 : 357) + high / window->screen.scale);
    ui_choose("Of", &window->forms.figure.pane, panes, PANE_COUNT,
              "drawn anew at this size: the place, the cone and the look that the pane has now");
    choose_size(&window->sheet);
    choose_dpi(&window->sheet);
    panel_property(window, PROPERTY_BACKGROUND);
    panel_property(window, PROPERTY_FIGURE_LEGEND);
    panel_property(window, PROPERTY_FIGURE_TEXT);
    if (plans_is_on(window->viewer)) {
        ui_text_wrapped(THEME_HINT, "without the plan's target, no-go areas and verdict: P saves the window with them");
    }
    ui_separator();
    if (preview) {
        ui_picture(preview->name, wide, high);
    }
    choose_name(window);
    ui_panel_end();
    window->viewer->version += !sheet_is_same(&before, &window->sheet);
}
