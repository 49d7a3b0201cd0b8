/* SPDX-License-Identifier: BSD-3-Clause */
/* The sheet of a picture: its size in pixels or millimetres, side, background and text. */
#include "figures/figure.h"

#include "options/messages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(member) offsetof(struct figure_settings, member)

enum { SIDE_LIMIT = 16384, PRINT_DPI = 300 };

static const double MM_PER_INCH = 25.4;

/* In the orders of conus_side and conus_legend. */
static const char *const sides[] = {"cone", "left", "right", "front", "back", "top", "bottom", NULL};
const char *const figure_legends[] = {"inside", "right", "below", "none", NULL};

const struct option figure_options[] = {
    {.name = "size",
     .type = OPTION_SIZE,
     .offset = FIELD(size),
     .value = "WxH",
     .help = "pixels, each 1 to 16384 (default 1400x1050)",
     .low = 1,
     .high = SIDE_LIMIT,
     .excludes = "width-mm"},
    {.name = "width-mm",
     .type = OPTION_NUMBER,
     .offset = FIELD(width_mm),
     .value = "MM",
     .help = "or the width on paper, mm, such as a column's 85",
     .low = 1,
     .high = 10000},
    {.name = "height-mm",
     .type = OPTION_NUMBER,
     .offset = FIELD(height_mm),
     .value = "MM",
     .help = "with --width-mm: the height (default three quarters of the width)",
     .low = 1,
     .high = 10000,
     .needs = "width-mm"},
    {.name = "dpi",
     .type = OPTION_NUMBER,
     .offset = FIELD(dpi),
     .value = "N",
     .help = "pixels per inch, which the file says, with letters of 7.5 points (default with --width-mm 300)",
     .low = 10,
     .high = 10000},
    {.name = "view",
     .type = OPTION_CHOICE,
     .offset = FIELD(side),
     .value = "SIDE",
     .help = "the whole atlas from the cone's side, or from this one:",
     .choices = sides,
     .excludes = "camera,camera-origin"},
    {.name = "background",
     .type = OPTION_TEXT,
     .offset = FIELD(background),
     .value = "COLOUR",
     .help = "light (default), white, black, transparent, or #RRGGBB",
     .words = "colour, color"},
    {.name = "legend",
     .type = OPTION_CHOICE,
     .offset = FIELD(legend),
     .value = "WHERE",
     .help = "where the legend is; without a cone it names what is drawn:",
     .choices = figure_legends,
     .excludes = "no-legend"},
    {.name = "legend-rows",
     .type = OPTION_COUNT,
     .offset = FIELD(legend_rows),
     .value = "N",
     .help = "of the objects in the legend only the first N, and a row that counts the others",
     .low = 1,
     .high = UINT32_MAX,
     .excludes = "no-legend"},
    {.name = "no-legend",
     .type = OPTION_FLAG,
     .offset = FIELD(no_legend),
     .help = "leave out the text, that of directions and scale, too"},
    {.name = "streamline-colour",
     .type = OPTION_TEXT,
     .offset = FIELD(streamline_colour),
     .value = "bundle|direction|NAME",
     .help = "what colours streamlines: their bundle, their direction (red: left-right, green: back-front, blue: "
             "up-down) or a number that their file has for points or streamlines, by its name (default: bundle)",
     .words = "color, fibre"},
    {.name = "safe-colours",
     .type = OPTION_FLAG,
     .offset = FIELD(safe_colours),
     .help = "colours of areas, pathways and bundles that people with any colour vision can tell apart",
     .words = "colour-blind, palette"},
    {0},
};

/* Whether `text` is a background; *kind and *rgb are what it means, NULL = the default. */
static bool parse_background(conus_background *kind, uint8_t rgb[3], const char *text)
{
    static const struct {
        const char *name;
        conus_background kind;
        uint8_t grey;
    } names[] = {{"light", CONUS_BACKGROUND_LIGHT, 0},
                 {"white", CONUS_BACKGROUND_COLOUR, 255},
                 {"black", CONUS_BACKGROUND_COLOUR, 0},
                 {"transparent", CONUS_BACKGROUND_TRANSPARENT, 0}};
    *kind = CONUS_BACKGROUND_LIGHT;
    for (size_t i = 0; text && i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(text, names[i].name) == 0) {
            *kind = names[i].kind;
            memset(rgb, names[i].grey, 3);
            return true;
        }
    }
    if (text && text[0] == '#' && strlen(text) == 7 && strspn(text + 1, "0123456789abcdefABCDEF") == 6) {
        unsigned long value = strtoul(text + 1, NULL, 16);
        *kind = CONUS_BACKGROUND_COLOUR;
        for (int c = 0; c < 3; c++) {
            rgb[c] = (uint8_t)(value >> (16 - 8 * c) & 0xff);
        }
        return true;
    }
    return !text;
}

static uint32_t pixels_of(double mm, double dpi)
{
    double pixels = rint(mm / MM_PER_INCH * dpi);
    return pixels < 1 ? 1 : pixels > UINT32_MAX ? UINT32_MAX : (uint32_t)pixels;
}

void figure_view(conus_view *view, const struct figure_settings *settings)
{
    double width = settings->width_mm;
    double height = settings->height_mm > 0 ? settings->height_mm : 0.75 * width;
    view->dpi = settings->dpi > 0 || width == 0 ? settings->dpi : PRINT_DPI;
    view->width = width > 0 ? pixels_of(width, view->dpi) : settings->size[0];
    view->height = width > 0 ? pixels_of(height, view->dpi) : settings->size[1];
    view->side = (conus_side)settings->side;
    view->legend = (conus_legend)settings->legend;
    view->legend_rows = settings->legend_rows;
    view->no_legend = settings->no_legend;
    parse_background(&view->background, view->background_rgb, settings->background);
}

bool figure_check(const struct figure_settings *settings)
{
    conus_view view = {0};
    if (!parse_background(&view.background, view.background_rgb, settings->background)) {
        print_error_line("--background: \"%s\"; allowed are light, white, black, transparent and #RRGGBB",
                         settings->background);
        return false;
    }
    figure_view(&view, settings);
    if (view.width > SIDE_LIMIT || view.height > SIDE_LIMIT) {
        print_error_line("--width-mm: %u x %u pixels at %g dpi, allowed is up to %d", view.width, view.height, view.dpi,
                         SIDE_LIMIT);
        return false;
    }
    return true;
}
