/* SPDX-License-Identifier: BSD-3-Clause */
/* The sheet by words, and figures. */
#include "viewer/commands/script_figure.h"

#include "options/messages.h"
#include "viewer/commands/script_words.h"
#include "viewer/window/figure_form.h"

#include <string.h>

static bool write_figure(struct window *window, size_t pane, const struct figure_settings *settings, const char *path)
{
    char why[FIGURE_REASON];
    bool fine = figure_write(window, pane, settings, path, why);
    if (!fine) {
        print_error_line("%s", why);
    }
    return fine;
}

bool script_picture(struct window *window, const char *path, const double size[2])
{
    const struct view_atlas *drawn = window->viewer->drawn;
    const struct figure_settings settings = {.size = {(uint32_t)size[0], (uint32_t)size[1]},
                                             .background = backdrop_names[window->viewer->display.backdrop],
                                             .streamline_colour = look_streamline_colour(&drawn->look, drawn->atlas)};
    return write_figure(window, PANE_3D, &settings, path);
}

bool script_figure(struct window *window, char *const *arguments, size_t count)
{
    struct figure_settings settings;
    size_t pane = count == 2 ? 0 : PANE_3D;
    while (count == 2 && pane < PANE_COUNT && strcmp(figure_panes[pane], arguments[1]) != 0) {
        pane++;
    }
    figure_of_window(&settings, window);
    return pane < PANE_COUNT && write_figure(window, pane, &settings, arguments[0]);
}

static bool set_size(struct sheet *sheet, bool in_mm, const char *width, const char *height)
{
    double size[2];
    double limit = in_mm ? SHEET_MM_LIMIT : SHEET_SIDE_LIMIT;
    bool fine = script_number(&size[0], width) && script_number(&size[1], height) && size[0] >= 1 && size[1] >= 1 &&
                size[0] <= limit && size[1] <= limit;
    for (int i = 0; i < 2 && fine; i++) {
        sheet->in_mm = in_mm;
        sheet->mm[i] = in_mm ? size[i] : sheet->mm[i];
        sheet->pixels[i] = in_mm ? sheet->pixels[i] : (uint32_t)size[i];
    }
    return fine;
}

static bool set_dpi(struct sheet *sheet, const char *value)
{
    double dpi;
    bool fine = script_number(&dpi, value) && (dpi == 0 || (dpi >= SHEET_DPI_LEAST && dpi <= SHEET_DPI_LIMIT));
    sheet->dpi = fine ? dpi : sheet->dpi;
    return fine;
}

static bool set_legend(struct sheet *sheet, const char *name)
{
    for (int i = 0; figure_legends[i]; i++) {
        if (strcmp(figure_legends[i], name) == 0) {
            sheet->legend = (conus_legend)i;
            return true;
        }
    }
    return false;
}

static bool set_text(struct sheet *sheet, const char *word)
{
    bool off = strcmp(word, "off") == 0;
    bool fine = off || strcmp(word, "on") == 0;
    sheet->no_text = fine ? off : sheet->no_text;
    return fine;
}

bool script_sheet(struct window *window, char *const *arguments, size_t count)
{
    struct sheet *sheet = &window->sheet;
    const char *what = arguments[0];
    window->viewer->version++;
    if (count == 3) {
        bool in_mm = strcmp(what, "mm") == 0;
        return (in_mm || strcmp(what, "pixels") == 0) && set_size(sheet, in_mm, arguments[1], arguments[2]);
    }
    return strcmp(what, "dpi") == 0      ? set_dpi(sheet, arguments[1])
           : strcmp(what, "legend") == 0 ? set_legend(sheet, arguments[1])
           : strcmp(what, "text") == 0   ? set_text(sheet, arguments[1])
                                         : false;
}
