/* SPDX-License-Identifier: BSD-3-Clause */
/* The legend of a picture: its rows, the place that it takes, and the corner of the drawing where it hides least. */
#include "selection/picture/picture.h"

#include "base/buffer.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/colour/pathways.h"
#include "render/flat/legend.h"

#include <stdio.h>
#include <string.h>

enum { TEXT_SIZE = PICTURE_TEXT, CELL_SIZE = 24, PATHWAY_ROWS = 5, COLOURS = 3, MARKS = 5, COLOUR_ROWS = MARKS + 2 };

/* The legend's part of the picture's width: inside, while letters of SMALLEST of their size are enough, and beside. */
static const double INSIDE = 0.42;
static const double BESIDE = 0.5;
static const double SMALLEST = 0.6;

/* The part of the drawing's width or height that it leaves free for a legend inside. */
static const double ROOM = 0.6;

static const char BEHIND[] = "behind";

/* The words of one row, which legend_row points to. */
struct cells {
    char share[CELL_SIZE], distance[CELL_SIZE];
};

struct picture_legend {
    struct legend legend;
    struct legend_row *rows;
    struct cells *cells;
    struct buffer *names; /* [name_count] of what shares its name */
    size_t name_count;
    char subtitle[TEXT_SIZE], words[TEXT_SIZE], more[TEXT_SIZE], colours[2 * COLOUR_ROWS][TEXT_SIZE];
    uint8_t bars[MARKS - 1][LEGEND_BAR][3];
    double at[2], size[2]; /* pixels of the image */
};

/* A cut has no colouring. */
static bool colours_streamlines(const struct picture *picture)
{
    return picture->streamlines && picture->streamlines->by != TUBE_BY_BUNDLE;
}

bool picture_has_legend(const struct picture *picture)
{
    return picture->font && picture->options.legend != CONUS_LEGEND_NONE &&
           (picture->options.selection || colours_streamlines(picture) || atlas_mapped_surface(picture->atlas));
}

/* With its kind where another kind has that name; without memory, too, the name alone. */
static const char *name_of(struct picture_legend *legend, const conus_atlas *atlas, uint32_t number)
{
    const char *name = atlas->objects[number - 1].name;
    const char *word = conus_atlas_kind_word(atlas, number);
    struct buffer *whole = &legend->names[legend->name_count];
    if (!word[0]) {
        return name;
    }
    buffer_format(whole, "%s %s", word, name);
    legend->name_count++;
    return whole->failed ? name : whole->data;
}

/* Its colour in the picture: of haze that of values in its upper part, which show most. */
static void set_chip(struct legend_row *row, const struct picture *picture, uint32_t number)
{
    memcpy(row->rgb, picture->atlas->objects[number - 1].rgb, sizeof row->rgb);
    if (haze_is(picture->hazy, number)) {
        const struct transfer *transfer = &picture->hazy->transfers[number];
        double low = transfer->points[0].value;
        double rgba[4];
        transfer_at(rgba, transfer, low + 0.7 * (transfer->points[transfer->count - 1].value - low));
        for (int c = 0; c < 3; c++) {
            row->rgb[c] = (uint8_t)lrint(255 * rgba[c]);
        }
    }
}

static void fill_row(struct picture_legend *out, size_t index, const struct picture *picture,
                     const conus_result *result)
{
    struct legend_row *row = &out->rows[index];
    struct cells *cells = &out->cells[index];
    bool is_behind = result->object && !result->pixels;
    snprintf(cells->share, sizeof cells->share, "%.1f %%", 100 * result->share);
    snprintf(cells->distance, sizeof cells->distance, "%.1f mm", is_behind ? result->entry : result->distance);
    row->detail[0] = is_behind ? BEHIND : cells->share;
    row->hollow = !result->object;
    row->name = "unassigned";
    if (result->object) {
        row->name = name_of(out, picture->atlas, result->object);
        set_chip(row, picture, result->object);
        row->detail[1] = cells->distance;
    }
}

/* Whether there are areas that are not drawn beside pathways. */
static bool leaves_out(const struct picture *picture)
{
    for (size_t number = 1; number <= picture->atlas->area_count; number++) {
        if (picture->areas[number] == PATHWAYS_AREA_LEFT_OUT && !conus_atlas_is_hidden(picture->atlas, number)) {
            return true;
        }
    }
    return false;
}

/* Adds what the picture shows beside what is hit: the pathways and bundles that are not hit, each while they
 * are few, and that the other areas are left out. */
static size_t add_pathways(struct picture_legend *out, struct legend_row rows[PATHWAY_ROWS],
                           const struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    size_t count = 0;
    size_t others = 0;
    size_t bundles = 0;
    for (size_t number = atlas->area_count + 1; number <= atlas->object_count; number++) {
        if (!conus_atlas_is_hidden(atlas, number) && picture->emphasis[number] == EMPHASIS_PALE) {
            bundles += atlas->objects[number - 1].kind == CONUS_KIND_BUNDLE;
            if (others++ < PATHWAY_ROWS - 1) {
                rows[count++] =
                    (struct legend_row){.name = name_of(out, atlas, (uint32_t)number), .detail = {"not hit"}};
                set_chip(&rows[count - 1], picture, (uint32_t)number);
            }
        }
    }
    if (others > count) {
        snprintf(out->words, TEXT_SIZE, "%zu %s", others,
                 !bundles            ? "pathways"
                 : bundles == others ? "bundles"
                                     : "pathways and bundles");
        rows[0] = (struct legend_row){.name = out->words, .hollow = true, .detail = {"not hit"}};
        count = 1;
    }
    if ((pathways_first(atlas) || pathways_shown(atlas)) && atlas_parcellation_count(atlas) && leaves_out(picture)) {
        rows[count++] = (struct legend_row){.name = "other areas", .hollow = true, .detail = {"not drawn"}};
    }
    return count;
}

/* Adds a bar of numbers, the largest above. */
static size_t add_bar(struct legend_row rows[MARKS], char words[MARKS][TEXT_SIZE], struct picture_legend *out,
                      double low, double high)
{
    double step = (high - low) / (MARKS - 1);
    double largest = fmax(fabs(low), fabs(high));
    int decimals = step > 0 ? (int)fmax(2 - floor(log10(step)), 0) : 0;
    bool is_plain = step > 0 && largest < 1e6 && decimals < 6; /* as many decimals at each mark */
    for (int i = 0; i < MARKS; i++) {
        double part = 1 - i / (MARKS - 1.0);
        snprintf(words[i], TEXT_SIZE, is_plain ? "%.*f" : "%.*g", is_plain ? decimals : 4, low + part * (high - low));
        rows[i] = (struct legend_row){.name = words[i], .mark = true};
        for (int k = 0; k < LEGEND_BAR && i; k++) {
            tube_scalar_colour(out->bars[i - 1][k], part + (1 - (k + 0.5) / LEGEND_BAR) / (MARKS - 1));
        }
        rows[i].bar = i ? (const uint8_t(*)[3])out->bars[i - 1] : NULL;
    }
    return MARKS;
}

/* Explains the colours of streamlines where these are not their bundles': a heading, and colours. */
static size_t add_streamlines(struct legend_row rows[COLOUR_ROWS], char words[COLOUR_ROWS][TEXT_SIZE],
                              struct picture_legend *out, const struct picture *picture)
{
    const struct tube_colouring *colouring = picture->streamlines;
    if (!colours_streamlines(picture)) {
        return 0;
    }
    snprintf(words[0], TEXT_SIZE, "Streamlines by %.*s", TEXT_SIZE / 2,
             colouring->by == TUBE_BY_DIRECTION ? "direction" : colouring->scalar);
    rows[0] = (struct legend_row){.name = words[0], .heading = true};
    if (colouring->by == TUBE_BY_SCALAR && colouring->low > colouring->high) {
        rows[1] = (struct legend_row){.name = "not known"};
        tube_scalar_colour(rows[1].rgb, NAN);
        return 2;
    }
    if (colouring->by == TUBE_BY_SCALAR) {
        return 1 + add_bar(rows + 1, words + 1, out, colouring->low, colouring->high);
    }
    for (int i = 0; i < COLOURS; i++) {
        static const char *const directions[COLOURS] = {"left to right", "back to front", "down to up"};
        rows[1 + i] = (struct legend_row){.name = directions[i]};
        rows[1 + i].rgb[i] = 255;
    }
    return 1 + COLOURS;
}

/* "leeway_mm" becomes "leeway, mm". */
static void describe_map(char out[TEXT_SIZE], const char *name)
{
    static const char *const units[][2] = {{"_mm", ", mm"}, {"_deg", ", degrees"}, {"_mm3", ", mm\u00b3"}};
    size_t length = strlen(name);
    const char *unit = "";
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        size_t end = strlen(units[i][0]);
        if (length > end && !*unit && strcmp(name + length - end, units[i][0]) == 0) {
            unit = units[i][1];
            length -= end;
        }
    }
    int shown = snprintf(out, TEXT_SIZE, "%.*s", (int)fmin((double)length, TEXT_SIZE / 2.0), name);
    for (char *c = out; *unit && *c; c++) {
        *c = *c == '_' ? ' ' : *c;
    }
    snprintf(out + shown, TEXT_SIZE - (size_t)shown, "%s", unit);
}

/* Explains the colours of a surface that has a map. */
static size_t add_map(struct legend_row rows[COLOUR_ROWS], char words[COLOUR_ROWS][TEXT_SIZE],
                      struct picture_legend *out, const struct picture *picture)
{
    const struct context_surface *surface = atlas_mapped_surface(picture->atlas);
    if (!surface) {
        return 0;
    }
    describe_map(words[0], surface->map_name);
    rows[0] = (struct legend_row){.name = words[0], .heading = true};
    return 1 + add_bar(rows + 1, words + 1, out, surface->low, surface->high);
}

/* The bars of streamlines and of a map are of the same colours: each has its own numbers beside it. */
static size_t add_colours(struct legend_row rows[2 * COLOUR_ROWS], struct picture_legend *out,
                          const struct picture *picture)
{
    size_t count = add_map(rows, out->colours, out, picture);
    return count + add_streamlines(rows + count, out->colours + COLOUR_ROWS, out, picture);
}

void picture_describe_cone(char out[PICTURE_TEXT], const struct cone *cone, const conus_frame *frame)
{
    static const char *const places[] = {", RAS mm", ", LPS mm", " \u00b5m in CCF", " mm from bregma"};
    const conus_space space = frame ? frame->space : CONUS_SPACE_RAS;
    bool rod = cone->radius > 0;
    double at[3];
    memcpy(at, cone->pose.world_from_device + 12, sizeof at);
    if (frame) {
        conus_frame_from_world(at, frame, at);
    }
    int size = snprintf(out, PICTURE_TEXT, "%s%.4g%s from", rod ? "radius " : "",
                        rod ? cone->radius : degrees_from_radians(cone->angle), rod ? " mm" : "\u00b0");
    for (size_t a = 0; a < 3; a++) {
        const char *axis = space < CONUS_SPACE_CCF ? "" : conus_space_axis(space, a);
        size += snprintf(out + size, PICTURE_TEXT - (size_t)size, "%s %s%s%.*g", a ? "," : "", axis, *axis ? " " : "",
                         space == CONUS_SPACE_CCF ? 6 : 4, at[a]);
    }
    snprintf(out + size, PICTURE_TEXT - (size_t)size, "%s", places[space]);
}

/* Fills the rows: what the cone hits, and what else is in the picture. */
static void fill_rows(struct picture_legend *out, const struct picture *picture)
{
    const conus_selection *selection = picture->options.selection;
    size_t count = 0;
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (picture_lists(result) || result->pierced) {
            fill_row(out, count, picture, result);
            count++;
        }
    }
    count += add_pathways(out, out->rows + count, picture);
    size_t tail = add_colours(out->rows + count, out, picture);
    picture_describe_cone(out->subtitle, &selection->cone, picture->options.frame);
    out->legend = (struct legend){.title = selection->has_layers ? "Hits of the cone" : "First hits of the cone",
                                  .subtitle = out->subtitle,
                                  .header = {"share", "distance"},
                                  .rows = out->rows,
                                  .count = count + tail,
                                  .tail = tail};
}

/* Makes `capacity` rows of more: the last of what is only behind others leave, and one row says how many they are.
 * Where those are too few, all stay, and legend_draw() counts what it leaves out. */
static void leave_out_behind(struct picture_legend *out, size_t capacity)
{
    struct legend_row *rows = out->rows;
    size_t behind = 0;
    for (size_t i = 0; i < out->legend.count; i++) {
        behind += rows[i].detail[0] == BEHIND;
    }
    size_t surplus = out->legend.count + 1 - capacity; /* the row that says so takes a line, too */
    if (behind < surplus) {
        return;
    }
    size_t kept = behind - surplus;
    size_t seen = 0;
    size_t count = 0;
    for (size_t i = 0; i < out->legend.count; i++) {
        seen += rows[i].detail[0] == BEHIND;
        if (rows[i].detail[0] != BEHIND || seen <= kept) {
            rows[count++] = rows[i];
        } else if (seen == kept + 1) {
            rows[count++] = (struct legend_row){.name = out->more, .hollow = true, .detail = {BEHIND}};
        }
    }
    snprintf(out->more, sizeof out->more, "\u2026 and %zu more", surplus);
    out->legend.count = count;
}

static void place_inside(struct picture_legend *legend, const struct picture *picture, double em)
{
    struct legend *drawn = &legend->legend;
    const double limit[2] = {INSIDE * picture->options.width, picture->options.height};
    drawn->widest = 1;
    drawn->size = legend_fit(legend->size, picture->font, drawn, limit, em, SMALLEST * em);
    size_t capacity = legend_capacity(drawn, drawn->size, limit[1]);
    if (drawn->count > capacity) {
        leave_out_behind(legend, capacity);
        drawn->size = legend_fit(legend->size, picture->font, drawn, limit, drawn->size, drawn->size);
    }
}

/* Makes place beside or below the drawing. */
static void place_outside(struct picture_legend *legend, struct picture *picture, double em)
{
    const bool right = picture->options.legend == CONUS_LEGEND_RIGHT;
    const double limit[2] = {(right ? BESIDE : 1) * picture->options.width, INFINITY};
    struct legend *drawn = &legend->legend;
    drawn->widest = 1;
    drawn->size = legend_fit(legend->size, picture->font, drawn, limit, em, SMALLEST * em);
    drawn->size = legend->size[0] > limit[0] ? legend_fit(legend->size, picture->font, drawn, limit, SMALLEST * em, 1)
                                             : drawn->size;
    double width = fmin(ceil(legend->size[0]), right ? picture->options.width - 1 : picture->options.width);
    double height = ceil(legend->size[1]);
    if (right) {
        picture->drawing[0] -= (uint32_t)width;
        legend->at[0] = picture->drawing[0];
        picture->sheet_height = (uint32_t)fmax(picture->sheet_height, height);
    } else {
        legend->at[1] = picture->drawing[1];
        picture->sheet_height += (uint32_t)height;
    }
    drawn->at = legend->at;
    drawn->ink = picture->ink;
}

static void legend_destroy(struct picture_legend *legend)
{
    if (legend) {
        for (size_t i = 0; i < legend->name_count; i++) {
            buffer_finish(&legend->names[i]);
        }
        memory_free(legend->names);
        memory_free(legend->rows);
        memory_free(legend->cells);
        memory_free(legend);
    }
}

void picture_legend_finish(struct picture *picture)
{
    legend_destroy(picture->legend);
    picture->legend = NULL;
}

conus_status picture_legend_init(struct picture *picture)
{
    size_t results = conus_selection_count(picture->options.selection);
    struct picture_legend *legend = memory_zeroed(1, sizeof *legend);
    if (legend) {
        legend->rows = memory_zeroed(results + PATHWAY_ROWS + 2 * COLOUR_ROWS, sizeof *legend->rows);
        legend->cells = memory_zeroed(results + 1, sizeof *legend->cells);
        legend->names = memory_zeroed(results + PATHWAY_ROWS, sizeof *legend->names);
    }
    if (!legend || !legend->rows || !legend->cells || !legend->names) {
        legend_destroy(legend);
        return CONUS_ERROR_MEMORY;
    }
    if (picture->options.selection) {
        fill_rows(legend, picture);
    } else {
        /* Without a cone, the heading of the colours is the title. */
        size_t count = add_colours(legend->rows, legend, picture);
        legend->legend = (struct legend){.title = legend->rows[0].name, .rows = legend->rows + 1, .count = count - 1};
    }
    if (picture->options.legend == CONUS_LEGEND_INSIDE) {
        place_inside(legend, picture, picture->em);
    } else {
        place_outside(legend, picture, picture->em);
    }
    picture->legend = legend;
    return CONUS_OK;
}

void picture_legend_room(double out[2], const struct picture *picture)
{
    out[0] = out[1] = 0;
    if (!picture->legend || picture->options.legend != CONUS_LEGEND_INSIDE) {
        return;
    }
    const double *size = picture->legend->size;
    double width = picture->drawing[0];
    double height = picture->drawing[1];
    bool above = size[0] > INSIDE * width && height - size[1] > width - size[0];
    out[above] = above ? fmin(size[1], ROOM * height) : fmin(size[0], ROOM * width);
}

void picture_lower(struct picture *picture, uint32_t height)
{
    struct picture_legend *legend = picture->legend;
    const conus_legend where = picture->options.legend;
    uint32_t beside = legend && where != CONUS_LEGEND_BELOW ? (uint32_t)ceil(legend->size[1]) : 0;
    uint32_t lowered = where == CONUS_LEGEND_INSIDE && beside > height ? beside : height;
    lowered = lowered < picture->drawing[1] ? lowered : picture->drawing[1];
    if (legend && where == CONUS_LEGEND_BELOW) {
        legend->at[1] = lowered;
        picture->sheet_height -= picture->drawing[1] - lowered;
    } else {
        picture->sheet_height = lowered > beside ? lowered : beside;
    }
    picture->drawing[1] = lowered;
}

/* Opacity that was drawn under a legend in a corner of the drawing. */
static double covered(const struct picture *picture, enum legend_corner corner)
{
    const uint32_t *drawing = picture->drawing;
    uint32_t width = (uint32_t)fmin(drawing[0], picture->legend->size[0]);
    uint32_t height = (uint32_t)fmin(drawing[1], picture->legend->size[1]);
    uint32_t left = corner == LEGEND_TOP_RIGHT ? drawing[0] - width : 0;
    uint32_t bottom = corner == LEGEND_BOTTOM_LEFT ? 0 : drawing[1] - height;
    double sum = 0;
    for (uint32_t y = bottom; y < bottom + height; y++) {
        for (uint32_t x = left; x < left + width; x++) {
            sum += (double)picture->rgba[4 * ((size_t)y * drawing[0] + x) + 3];
        }
    }
    return sum;
}

conus_status picture_legend_draw(conus_image *image, const struct picture *picture)
{
    struct legend legend = picture->legend->legend;
    if (picture->options.legend == CONUS_LEGEND_INSIDE) {
        /* The corner in which the legend hides least; the fourth one is taken by the directions. */
        static const enum legend_corner corners[] = {LEGEND_TOP_LEFT, LEGEND_TOP_RIGHT, LEGEND_BOTTOM_LEFT};
        legend.corner = LEGEND_TOP_LEFT;
        double least = INFINITY;
        for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
            double hidden = covered(picture, corners[i]);
            if (hidden < 0.8 * least) {
                least = hidden;
                legend.corner = corners[i];
            }
        }
    }
    return legend_draw(image, picture->font, &legend);
}
