/* SPDX-License-Identifier: BSD-3-Clause */
/* The sheet of a picture: its size in pixels or millimetres, side, background and text. */
#include "figures/figure.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_LIMIT = 16384, PRINT_DPI = 300, PRINT_MM = 180 };

static const double MM_PER_INCH = 25.4;

enum { STYLE_AUTO, STYLE_SCREEN, STYLE_PRINT };
static const char *const styles[] = {"auto", "screen", "print", NULL};

/* In the orders of conus_side, after the first, and conus_legend. */
static const char *const sides[] = {"auto", "cone",   "left",   "right",  "front", "back",
                                    "top",  "bottom", "beside", "across", NULL};
static const char *const legends[] = {"auto", "right", "below", "none", NULL};

const struct option figure_options[] = {
    {OPTION_VALUED("style", struct figure_settings, style, "STYLE"),
     .help = "print: white, seen from beside the cone, with thin lines around what is drawn and letters of panels, 180 "
             "mm wide unless --size or --width-mm is given; what other options say counts; auto is print with "
             "--width-mm, else screen:",
     .choices = styles, .words = "paper, publication, journal"},
    {OPTION_VALUED("size", struct figure_settings, size, "WxH"), .help = "pixels, each 1 to 16384",
     .otherwise = "1400x1050, in print 180 mm wide, of cuts as they need", .low = 1, .high = SIDE_LIMIT,
     .excludes = "width-mm", .unit = "pixels"},
    {OPTION_MM("width-mm", struct figure_settings, width_mm),
     .help = "or the width on paper, mm, such as a column's 85", .low = 1, .high = 10000},
    {OPTION_MM("height-mm", struct figure_settings, height_mm), .help = "with --width-mm: the height",
     .otherwise = "three quarters of the width", .low = 1, .high = 10000, .needs = "width-mm"},
    {OPTION_VALUED("dpi", struct figure_settings, dpi, "N"),
     .help = "pixels per inch, which the file says, with letters of 7 points", .otherwise = "with --width-mm 300",
     .low = 10, .high = 10000, .unit = "1/inch"},
    {OPTION_VALUED("view", struct figure_settings, side, "SIDE"),
     .help = "the whole atlas from this side; beside is 60 degrees off the cone's axis, across at right "
             "angles to it, from above; auto is cone, in print beside, of a beam across:",
     .choices = sides, .excludes = "camera,camera-origin"},
    {OPTION_VALUED("background", struct figure_settings, background, "COLOUR"),
     .help = "light, white, black, transparent, or #RRGGBB", .otherwise = "light, in print white",
     .words = "colour, color"},
    {OPTION_VALUED("legend", struct figure_settings, legend, "WHERE"),
     .help = "where the legend is: auto is right of a picture that is wide enough, else below; without a cone it names "
             "what is drawn:",
     .choices = legends, .excludes = "no-legend"},
    {OPTION_VALUED("legend-rows", struct figure_settings, legend_rows, "N"),
     .help = "of the objects in the legend only the first N, and a row that counts the others",
     .otherwise = "12, of probes all", .low = 1, .high = UINT32_MAX, .excludes = "no-legend"},
    {OPTION_NAMED("no-legend", struct figure_settings, no_legend),
     .help = "leave out the text, that of directions and scale, too"},
    {OPTION_VALUED("streamline-colour", struct figure_settings, streamline_colour, "bundle|direction|NAME"),
     .help = "what colours streamlines: their bundle, their direction (red: left-right, green: back-front, blue: "
             "up-down) or a number that their file has for points or streamlines, by its name",
     .standard = "bundle", .words = "color, fibre"},
    {OPTION_NAMED("safe-colours", struct figure_settings, safe_colours),
     .help = "colours of areas, pathways and bundles that people with any colour vision can tell apart, in pictures "
             "without a cone: those by rank are such",
     .words = "colour-blind"},
    {OPTION_VALUED("palette", struct figure_settings, palette, "rank|file|NAME|COLOURS|FILE"),
     .help = "colours of areas, pathways and bundles, different ones where areas touch: safe, bright, muted, set2, "
             "dark2, tab10, a list of #RRGGBB, or a file with such a list; file: those of the atlas; rank: what is hit "
             "has a colour by its place in the answer, all else is grey",
     .otherwise = "rank with a cone, else file", .words = "color, colormap", .excludes = "safe-colours",
     OPTION_READING(COLOURS)},
    {OPTION_VALUED("unselected", struct figure_settings, unselected, "COLOUR"),
     .help = "white, black or #RRGGBB: one tone of areas and pathways that are not hit",
     .otherwise = "a grey, or by --palette their colours, paler", .words = "color, grey, gray"},
    {0},
};

enum { PALETTE_LIMIT = 80, PALETTE_BYTES = 1 << 20 };

/* Whether six hexadecimal digits begin there. */
static bool parse_hex(uint8_t rgb[3], const char *text)
{
    if (strspn(text, "0123456789abcdefABCDEF") < 6) {
        return false;
    }
    const char digits[7] = {text[0], text[1], text[2], text[3], text[4], text[5], '\0'};
    unsigned long value = strtoul(digits, NULL, 16);
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)(value >> (16 - 8 * c) & 0xff);
    }
    return true;
}

static bool parse_rgb(uint8_t rgb[3], const char *text)
{
    bool is_black = strcmp(text, "black") == 0;
    if (is_black || strcmp(text, "white") == 0) {
        memset(rgb, is_black ? 0 : 255, 3);
        return true;
    }
    return text[0] == '#' && strlen(text) == 7 && parse_hex(rgb, text + 1);
}

/* All #RRGGBB in the text, whatever is between them. Returns how many there are; of too many the first. */
static size_t find_colours(uint8_t rgb[PALETTE_LIMIT][3], const char *text)
{
    size_t count = 0;
    for (const char *at = text; (at = strchr(at, '#')); at++) {
        bool is_colour = strspn(at + 1, "0123456789abcdefABCDEF") == 6 && count < PALETTE_LIMIT;
        count += is_colour && parse_hex(rgb[count], at + 1);
    }
    return count;
}

/* Bright and muted are P. Tol's (2021), set2 and dark2 C. Brewer's (2003), tab10 M. Stone's (Tableau, 2016). */
static const struct {
    const char *name, *colours;
} palettes[] = {{"bright", "#4477AA #EE6677 #228833 #CCBB44 #66CCEE #AA3377 #BBBBBB"},
                {"muted", "#CC6677 #332288 #DDCC77 #117733 #88CCEE #882255 #44AA99 #999933 #AA4499"},
                {"set2", "#66C2A5 #FC8D62 #8DA0CB #E78AC3 #A6D854 #FFD92F #E5C494 #B3B3B3"},
                {"dark2", "#1B9E77 #D95F02 #7570B3 #E7298A #66A61E #E6AB02 #A6761D #666666"},
                {"tab10", "#1F77B4 #FF7F0E #2CA02C #D62728 #9467BD #8C564B #E377C2 #7F7F7F #BCBD22 #17BECF"}};

int figure_colour_atlas(conus_atlas *atlas, const struct figure_settings *settings)
{
    const char *palette = settings->palette;
    uint8_t rgb[PALETTE_LIMIT][3];
    char *file = NULL;
    size_t size = 0;
    if (settings->safe_colours || (palette && strcmp(palette, "safe") == 0)) {
        conus_atlas_use_safe_colours(atlas);
        return EXIT_DONE;
    }
    if (palette && (strcmp(palette, "rank") == 0 || strcmp(palette, "file") == 0)) {
        return EXIT_DONE;
    }
    const char *text = palette && palette[0] == '#' ? palette : NULL;
    for (size_t i = 0; palette && i < sizeof palettes / sizeof *palettes; i++) {
        text = strcmp(palette, palettes[i].name) == 0 ? palettes[i].colours : text;
    }
    if (palette && !text && !conus_atlas_is_path(palette)) {
        return print_usage_error(
            "--palette: \"%s\" is neither rank, file, safe, bright, muted, set2, dark2, tab10, a list "
            "of #RRGGBB nor a file",
            palette);
    }
    if (!text) {
        conus_inputs_add(palette);
    }
    int code = palette && !text ? input_file_read(&file, &size, palette, INPUT_FILE, PALETTE_BYTES) : EXIT_DONE;
    size_t count = code || !palette ? 0 : find_colours(rgb, text ? text : file);
    free(file);
    if (!code && palette && !count) {
        print_error_line("--palette: %s: no #RRGGBB in it", palette);
        return text ? EXIT_USAGE : EXIT_DATA;
    }
    conus_status status = count ? conus_atlas_use_palette(atlas, rgb[0], count) : CONUS_OK;
    return code || !status ? code : print_status(status);
}

/* Whether `text` is a background; *kind and *rgb are what it means, NULL = the default. */
static bool parse_background(conus_background *kind, uint8_t rgb[3], const char *text)
{
    bool is_transparent = text && strcmp(text, "transparent") == 0;
    bool is_light = !text || strcmp(text, "light") == 0;
    *kind = is_transparent ? CONUS_BACKGROUND_TRANSPARENT : is_light ? CONUS_BACKGROUND_LIGHT : CONUS_BACKGROUND_COLOUR;
    return is_transparent || is_light || parse_rgb(rgb, text);
}

static uint32_t pixels_of(double mm, double dpi)
{
    double pixels = rint(mm / MM_PER_INCH * dpi);
    return pixels < 1 ? 1 : pixels > UINT32_MAX ? UINT32_MAX : (uint32_t)pixels;
}

static bool is_print(const struct figure_settings *settings)
{
    return settings->style == STYLE_PRINT || (settings->style == STYLE_AUTO && settings->width_mm > 0);
}

void figure_view(conus_view *view, const struct figure_settings *settings)
{
    const bool print = is_print(settings);
    double width = settings->width_mm > 0 || !print || settings->size[0] ? settings->width_mm : PRINT_MM;
    double height = settings->height_mm > 0 ? settings->height_mm : 0.75 * width;
    view->dpi = settings->dpi > 0 || width == 0 ? settings->dpi : PRINT_DPI;
    view->width = width > 0 ? pixels_of(width, view->dpi) : settings->size[0];
    view->height = width > 0 ? pixels_of(height, view->dpi) : settings->size[1];
    view->print = print;
    view->side = settings->side                              ? (conus_side)(settings->side - 1)
                 : print && view->selection && !view->camera ? CONUS_SIDE_BESIDE_CONE
                                                             : CONUS_SIDE_OF_CONE;
    view->legend = (conus_legend)settings->legend;
    view->legend_rows = settings->legend_rows;
    view->no_legend = settings->no_legend;
    parse_background(&view->background, view->background_rgb,
                     settings->background ? settings->background
                     : print              ? "white"
                                          : NULL);
    view->own_colours = settings->palette && strcmp(settings->palette, "file") == 0;
    view->has_unselected = settings->unselected && parse_rgb(view->unselected_rgb, settings->unselected);
}

bool figure_check(const struct figure_settings *settings)
{
    conus_view view = {0};
    if (!parse_background(&view.background, view.background_rgb, settings->background)) {
        print_error_line("--background: \"%s\"; allowed are light, white, black, transparent and #RRGGBB",
                         settings->background);
        return false;
    }
    uint8_t rgb[3];
    if (settings->unselected && !parse_rgb(rgb, settings->unselected)) {
        print_error_line("--unselected: \"%s\"; allowed are white, black and #RRGGBB", settings->unselected);
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
