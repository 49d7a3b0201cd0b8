/* SPDX-License-Identifier: BSD-3-Clause */
/* The legend of a picture: its rows, and the place beside or below the drawing that it takes. */
#include "selection/picture/picture.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "base/path.h"
#include "base/text.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "render/draw/draw.h"
#include "render/image/image.h"
#include "selection/measure/measure.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum {
    TEXT_SIZE = PICTURE_TEXT,
    OTHER_ROWS = 3, /* what is in the cone without being hit, what is not drawn, sides that are exchanged */
    MARKS = 5,
    COLOUR_ROWS = MARKS + 2,
    GROUP_ROWS = 12, /* of points */
    KEYS = 3
};

/* The legend's part of the picture's width beside the drawing: at most, and where nobody said that it stands there. */
static const double BESIDE = 0.5;
static const double SLIM = 0.4;

/* Height that a legend below adds to the picture, as a part of it: at most, and on paper. */
static const double BELOW = 0.5;
static const double BELOW_IN_PRINT = 1;
static const double SMALLEST = 6.0 / 7;

/* Below the drawing a column has at least so many rows. */
enum { LEAST_ROWS = 3 };

/* A share that would be 0.0 %. */
static const double NO_SHARE = 0.0005;

static const char BEHIND[] = "behind";

/* Of a tube with at most this radius, mm, the part of its cross-section that meets something first says nothing. */
static const double NEEDLE = 3;

/* The words about a selection. */
struct wording {
    const char *first, *all; /* titles, of first hits and of all layers */
    bool has_share, has_length;
    const char *place[2]; /* the heads of where it hits, or with all layers enters, an object */
};

static const struct wording *wording_of(const conus_view *options)
{
    static const struct wording cone = {
        "First hits of the cone", "Hits of the cone", true, false, {"distance", "entry"}};
    static const struct wording tube = {
        "First hits of the cylinder", "The cylinder passes", true, true, {"entered at", "entered at"}};
    static const struct wording needle = {
        "The needle enters first", "The needle passes", false, true, {"entered at", "entered at"}};
    static const struct wording beam = {
        "The beam passes", "The beam passes", false, true, {"from focus", "from focus"}};
    const double radius = options->selection->cone.radius;
    return options->is_beam ? &beam : radius > NEEDLE ? &tube : radius > 0 ? &needle : &cone;
}

struct picture_legend {
    struct legend legend;
    struct legend_row *rows;
    char **texts; /* [text_count] what say() gave */
    size_t text_count, text_capacity;
    bool failed;                               /* a text found no memory */
    uint8_t bars[2][MARKS - 1][LEGEND_BAR][3]; /* of the ramp of numbers, and of haze */
    uint8_t ramp[LEGEND_BAR][3];               /* the chip of the only haze that is coloured by its values */
    uint8_t tubes[LEGEND_BAR][3];              /* that of streamlines that are not coloured by bundle */
    double size[2];                            /* pixels of the image */
    bool is_right;                             /* of the drawing, not below it */
};

/* A text that lasts as long as the legend. */
static __attribute__((format(printf, 2, 3))) const char *say(struct picture_legend *legend, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    char *text = memory_raw((size_t)length + 1, 1);
    if (!text ||
        !memory_reserve(&legend->texts, &legend->text_capacity, legend->text_count + 1, sizeof *legend->texts)) {
        memory_free(text);
        legend->failed = true;
        return "";
    }
    va_start(args, format);
    vsnprintf(text, (size_t)length + 1, format, args);
    va_end(args);
    return legend->texts[legend->text_count++] = text;
}

static struct legend_row *add_row(struct picture_legend *legend, const char *name)
{
    struct legend_row *row = &legend->rows[legend->legend.count++];
    *row = (struct legend_row){.name = name};
    return row;
}

/* A cut has no colouring. */
static bool colours_streamlines(const struct picture *picture)
{
    return picture->streamlines && picture->streamlines->by != TUBE_BY_BUNDLE;
}

/* As far as that is known. */
static bool is_seen(const struct picture *picture, size_t number)
{
    return !picture->seen || picture->seen[number] >= PICTURE_LEAST_PART;
}

/* Whether the pathway is seen as haze coloured by its values, not by a colour of its own. */
static bool is_by_value(const struct picture *picture, size_t number)
{
    bool is_hazy =
        haze_is(picture->hazy, number) && !conus_atlas_is_hidden(picture->atlas, number) && is_seen(picture, number);
    const struct transfer *transfer = is_hazy ? &picture->hazy->transfers[number] : NULL;
    bool found = false;
    for (size_t i = 0; transfer && i < transfer->count && !found; i++) {
        for (int c = 0; c < 3; c++) {
            double own = picture->atlas->objects[number - 1].rgb[c] / 255.0;
            found = found || fabs(transfer->points[i].rgba[c] - own) > 1e-6;
        }
    }
    return found;
}

static size_t count_by_value(const struct picture *picture)
{
    size_t count = 0;
    for (size_t number = 1; number <= picture->atlas->object_count; number++) {
        count += is_by_value(picture, number);
    }
    return count;
}

/* Without a cone a legend that is asked for, by its place or its rows, names all that has a colour in the picture. */
bool picture_lists_all(const struct picture *picture)
{
    const conus_view *options = &picture->options;
    bool has_place = options->legend == CONUS_LEGEND_RIGHT || options->legend == CONUS_LEGEND_BELOW;
    bool is_long = options->legend_rows && options->legend != CONUS_LEGEND_NONE;
    return (picture->hazy || picture->seen) && (has_place || is_long) && !options->selection && !options->listed;
}

bool picture_stands_out(const struct picture *picture, size_t number)
{
    const conus_view *options = &picture->options;
    bool is_given = options->opacity && options->opacity[number] > 0;
    return options->listed ? options->listed[number] : options->selection && is_given;
}

void picture_keep_listed(struct picture *picture)
{
    for (size_t n = 1; picture->emphasis && n <= picture->atlas->object_count; n++) {
        bool keeps = picture->emphasis[n] == EMPHASIS_PALE && picture_stands_out(picture, n);
        picture->emphasis[n] = keeps ? EMPHASIS_FULL : picture->emphasis[n];
    }
}

bool picture_draws(const struct picture *picture, uint32_t number)
{
    const conus_atlas *atlas = picture->atlas;
    const struct object_place *place = &atlas->places[number - 1];
    bool has_voxels = atlas_object_volume(atlas, number) && atlas->objects[number - 1].voxels;
    bool is_left_out = has_voxels && number <= atlas->area_count && pathways_shown(atlas) &&
                       picture->areas[number] == PATHWAYS_AREA_LEFT_OUT;
    bool shows = !picture->opacity || picture->opacity[number] > 0 || haze_is(picture->hazy, number) ||
                 place->is_bundle; /* an opacity does not change tubes */
    return shows && !is_left_out && !conus_atlas_is_hidden(atlas, number) &&
           (place->is_mesh || place->is_bundle || has_voxels);
}

/* Whether the legend has a row for it even if the cone does not hit it. */
static bool is_listed(const struct picture *picture, uint32_t number)
{
    bool is_pale = picture->emphasis && picture->emphasis[number] == EMPHASIS_PALE;
    bool counts = picture_lists_all(picture) && is_seen(picture, number) && !is_pale;
    return picture_draws(picture, number) &&
           (picture_stands_out(picture, number) || counts || is_by_value(picture, number));
}

/* Whether there is something to explain: hits of a cone, objects that are listed, or colours that stand for something.
 */
static bool has_meaning(const struct picture *picture)
{
    return !picture->options.probe_count &&
           (picture->options.selection || picture->options.listed || picture_lists_all(picture) ||
            picture_has_groups(picture) || colours_streamlines(picture) || count_by_value(picture) ||
            atlas_mapped_surface(picture->atlas));
}

/* Whether something of another rank has the same colour. */
static bool shares_colour(const struct picture *picture, uint32_t number)
{
    bool found = false;
    for (size_t n = 1; n <= picture->atlas->object_count && !found; n++) {
        found = picture->ranks[n] && picture->ranks[n] != picture->ranks[number] &&
                memcmp(picture->rgb[n], picture->rgb[number], 3) == 0;
    }
    return found;
}

size_t picture_tag(const struct picture *picture, uint32_t number)
{
    size_t tag = 1;
    if (picture->names) {
        return picture->names[number].number;
    }
    if (picture->ranks && picture->ranks[number]) { /* not of areas behind others: they are not seen there */
        const bool *listed = picture->options.listed;
        bool is_asked_for = number > picture->atlas->area_count || (listed && listed[number]);
        bool is_alike =
            picture->atlas->has_palette ? shares_colour(picture, number) : picture->ranks[number] > PICTURE_RANKS;
        const uint32_t rows = picture->options.legend_rows; /* a number behind them says nothing */
        bool has_row = is_asked_for || !rows || picture->ranks[number] <= rows;
        bool is_meant = is_asked_for || picture->emphasis[number] == EMPHASIS_FULL;
        return is_alike && has_row && is_meant ? picture->ranks[number] : 0;
    }
    for (size_t before = 1; before < number; before++) {
        tag += is_by_value(picture, before);
    }
    return is_by_value(picture, number) && count_by_value(picture) > 1 ? tag : 0;
}

bool picture_is_hidden(const struct picture *picture, uint32_t number)
{
    bool hidden = picture->seen;
    for (uint32_t n = 1; hidden && n <= picture->atlas->object_count; n++) {
        hidden = picture->seen[n] == 0 || !atlas_is_below(picture->atlas, n, number);
    }
    return hidden;
}

/* What stands between words of a name. */
static bool is_joint(char c)
{
    return c == '_' || c == ' ' || c == '.' || c == '-';
}

/* Writes a name as people do: with spaces, and "left" or "right" for a letter of the side that the area has. */
static void write_name(char out[PICTURE_TEXT], const struct picture *picture, uint32_t number)
{
    const char *name = picture->atlas->objects[number - 1].name;
    const size_t size = strlen(name);
    const char side = picture->sides ? picture->sides[number] : 0;
    const bool is_first = size > 2 && toupper((unsigned char)name[0]) == side && is_joint(name[1]);
    const bool is_last =
        size > 2 && !is_first && toupper((unsigned char)name[size - 1]) == side && is_joint(name[size - 2]);
    const char *words = side == 'L' ? "left" : "right";
    snprintf(out, PICTURE_TEXT, "%s%.*s%s", is_first ? words : "", (int)(size - (is_first || is_last)), name + is_first,
             is_last ? words : "");
    for (char *c = out; *c; c++) {
        *c = *c == '_' ? ' ' : *c;
    }
}

const char *picture_name(char out[PICTURE_TEXT], const struct picture *picture, uint32_t number)
{
    const conus_atlas *atlas = picture->atlas;
    const char *own = atlas->objects[number - 1].name;
    const char *word = picture->prefixes ? picture->prefixes[number] : "";
    const struct volume *volume = atlas_object_volume(atlas, number);
    const char *path = volume ? volume->info.path : conus_atlas_file(atlas, 0);
    char other[PICTURE_TEXT];
    if (word[0]) {
        snprintf(out, PICTURE_TEXT, "%s %s", word, own);
        return out;
    }
    const char *title = path_title(out, PICTURE_TEXT, own, path ? path : "");
    if (title != own || conus_atlas_exchanged(atlas) || strlen(own) + sizeof "right" >= PICTURE_TEXT) {
        return title;
    }
    write_name(out, picture, number);
    for (uint32_t n = 1; n <= atlas->object_count; n++) { /* two that would then be one stay as they are */
        write_name(other, picture, n);
        if (strcmp(other, out) == 0 && strcmp(atlas->objects[n - 1].name, own) != 0) {
            return own;
        }
    }
    return out;
}

/* sRGB of a function between its first point, part 0, and its last, 1. */
static void transfer_part_colour(uint8_t rgb[3], const struct transfer *transfer, double part)
{
    double rgba[4];
    double low = transfer->points[0].value;
    transfer_at(rgba, transfer, low + part * (transfer->points[transfer->count - 1].value - low));
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)lrint(255 * rgba[c]);
    }
}

conus_status picture_rank(struct picture *picture, bool on_dark)
{
    const conus_view *options = &picture->options;
    if (!picture->emphasis || options->probe_count || options->own_colours) {
        return CONUS_OK;
    }
    picture->ranks = options->selection ? picture_ranks(options->selection)
                                        : memory_zeroed(picture->atlas->object_count + 1, sizeof *picture->ranks);
    for (size_t n = 1; picture->ranks && n <= picture->atlas->object_count; n++) { /* haze has its colours */
        picture->ranks[n] = haze_is(picture->hazy, n) ? 0 : picture->ranks[n];
    }
    if (picture->ranks) {
        const uint8_t *given = options->unselected_rgb;
        const unsigned not_hit = options->has_unselected ? (unsigned)given[0] << 16 | given[1] << 8 | given[2]
                                 : on_dark               ? LOOK_NOT_HIT
                                                         : LOOK_NOT_HIT_ON_WHITE;
        picture->rgb =
            picture_rank_colours(picture->ranks, picture->atlas, not_hit, options->listed, options->selection);
        picture->line_rgb = picture_rank_colours(picture->ranks, picture->atlas, LOOK_OUTLINE, options->listed, NULL);
    }
    for (size_t n = 1; picture->line_rgb && n <= picture->atlas->object_count; n++) {
        if (is_by_value(picture, n)) { /* the colour in which it begins */
            transfer_part_colour(picture->line_rgb[n], &picture->hazy->transfers[n], 0);
        }
    }
    return picture->rgb && picture->line_rgb ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void picture_colour(uint8_t out[3], const struct picture *picture, size_t number)
{
    bool has_own = !picture->rgb || haze_is(picture->hazy, number);
    if (is_by_value(picture, number) && count_by_value(picture) == 1) { /* several have numbers */
        transfer_part_colour(out, &picture->hazy->transfers[number], 0.5);
    } else {
        memcpy(out, has_own ? picture->atlas->objects[number - 1].rgb : picture->rgb[number], 3);
    }
}

void picture_ink_on(float out[4], const struct picture *picture, uint32_t number)
{
    uint8_t rgb[3];
    picture_colour(rgb, picture, number);
    draw_colour(out, rgb, 1);
    out[0] = out[1] = out[2] = 0.2126F * out[0] + 0.7152F * out[1] + 0.0722F * out[2] > 0.179F ? 0 : 1;
}

/* Those of directions, one beside the other, or of a number. */
static void set_tube_chip(struct legend_row *row, struct picture_legend *out, const struct picture *picture)
{
    const struct tube_colouring *by = picture->streamlines;
    for (int k = 0; k < LEGEND_BAR; k++) {
        const double part = (k + 0.5) / LEGEND_BAR;
        const double axis[3] = {part < 1.0 / 3, part >= 1.0 / 3 && part < 2.0 / 3, part >= 2.0 / 3};
        if (by->by == TUBE_BY_DIRECTION) {
            tube_direction_colour(out->tubes[k], axis);
        } else {
            tube_scalar_colour(out->tubes[k], by->low > by->high ? NAN : part);
        }
    }
    row->ramp = (const uint8_t(*)[3])out->tubes;
}

/* Its colour in the picture, those of its values or streamlines, or stripes where it has some. */
static void set_chip(struct legend_row *row, struct picture_legend *out, const struct picture *picture, uint32_t number)
{
    bool is_pale = picture->emphasis && picture->emphasis[number] == EMPHASIS_PALE;
    picture_colour(row->rgb, picture, number);
    if (colours_streamlines(picture) && !is_pale && picture->atlas->objects[number - 1].kind == CONUS_KIND_BUNDLE) {
        set_tube_chip(row, out, picture);
    }
    if (is_by_value(picture, number) && count_by_value(picture) == 1) {
        for (int k = 0; k < LEGEND_BAR; k++) {
            transfer_part_colour(out->ramp[k], &picture->hazy->transfers[number], (k + 0.5) / LEGEND_BAR);
        }
        row->ramp = (const uint8_t(*)[3])out->ramp;
    }
    row->striped = picture->emphasis && picture->emphasis[number] == EMPHASIS_HATCHED;
}

/* Adds a row with an object's name: behind its number in the picture, and saying so where it is hidden. From the
 * seventh rank on a chip without a number would be that of several. */
static struct legend_row *add_object(struct picture_legend *legend, const struct picture *picture, uint32_t number,
                                     bool hidden)
{
    const char *own = picture->atlas->objects[number - 1].name;
    char text[PICTURE_TEXT];
    const char *name = picture_name(text, picture, number);
    const size_t number_shown = picture_tag(picture, number);
    char tag[PICTURE_NUMBER] = "";
    if (number_shown) {
        snprintf(tag, sizeof tag, "%zu  ", number_shown);
    }
    struct legend_row *row = add_row(legend, say(legend, "%s%s%s", tag, name, hidden ? " (not seen)" : ""));
    row->own = picture->prefixes[number][0] || strcmp(name, own) == 0 ? NULL : own;
    row->bare =
        !number_shown && picture->ranks && picture->ranks[number] > PICTURE_RANKS && !picture->atlas->has_palette;
    row->written = picture->names && picture->names[number].lines > 0 && !picture->names[number].number;
    set_chip(row, legend, picture, number);
    return row;
}

/* With all layers, from the apex to where the cone enters it, whether or not it is hit first. */
static void add_result(struct picture_legend *out, const struct picture *picture, const conus_result *result)
{
    const bool is_entry = picture->options.selection->has_layers;
    const struct wording *words = wording_of(&picture->options);
    const bool is_behind = result->object && !result->pixels;
    char share[TEXT_SHARE_SIZE];
    int column = 0;
    if (!result->object && !words->has_share) {
        return;
    }
    struct legend_row *row = result->object ? add_object(out, picture, result->object,
                                                         result->pixels && picture_is_hidden(picture, result->object))
                                            : add_row(out, "unassigned");
    row->plain = !result->object;
    if (words->has_share) {
        row->detail[column++] = is_behind ? BEHIND : say(out, "%s %%", text_share(share, result->share, 1));
    }
    if (result->object) {
        row->detail[column++] = say(out, "%.1f mm", is_entry ? result->entry : result->distance);
        row->detail[column] = words->has_length && is_entry ? say(out, "%.1f mm", result->path) : NULL;
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

/* Whether streamlines of a bundle that is not hit first are in full colours in the cone, as those of its own are not.
 * Without memory none is. */
static bool is_entered(const struct picture *picture, uint32_t number)
{
    const conus_atlas *atlas = picture->atlas;
    uint32_t *streamlines = NULL;
    size_t count = 0;
    bool found = colours_streamlines(picture) && atlas->objects[number - 1].kind == CONUS_KIND_BUNDLE &&
                 !tract_census_list(&streamlines, &count, atlas, number, &picture->options.selection->region);
    memory_free(streamlines);
    return found && count > 0;
}

/* Adds rows for bundles that are not hit first and of which streamlines are coloured in the cone, while they are few.
 */
static void add_pathways(struct picture_legend *out, const struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    for (uint32_t number = (uint32_t)atlas->area_count + 1; number <= atlas->object_count; number++) {
        if (picture_draws(picture, number) && !is_listed(picture, number) &&
            picture->emphasis[number] == EMPHASIS_PALE && is_entered(picture, number)) {
            struct legend_row *row = add_object(out, picture, number, false);
            row->detail[0] = "passes";
            set_tube_chip(row, out, picture);
        }
    }
}

/* Adds a row that says so where areas are left out; without a cone, only below others. */
static void add_left_out(struct picture_legend *out, const struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    if ((pathways_first(atlas) || pathways_shown(atlas)) && atlas_parcellation_count(atlas) && leaves_out(picture) &&
        (picture->options.selection || out->legend.count)) {
        struct legend_row *row = add_row(out, "other areas");
        row->plain = true;
        row->detail[0] = "not drawn";
    }
}

/* Adds a bar of numbers, the largest above, with the colours of `transfer` from its first point to its last, or without
 * one those of tube_scalar_colour(). */
static void add_bar(struct picture_legend *out, double low, double high, const struct transfer *transfer)
{
    uint8_t(*bars)[LEGEND_BAR][3] = out->bars[transfer ? 1 : 0];
    double step = (high - low) / (MARKS - 1);
    double largest = fmax(fabs(low), fabs(high));
    int decimals = step > 0 ? (int)fmax((transfer ? 1 : 2) - floor(log10(step)), 0) : 0;
    bool is_plain = step > 0 && largest < 1e6 && decimals < 6; /* as many decimals at each mark */
    for (int i = 0; i < MARKS; i++) {
        double part = 1 - i / (MARKS - 1.0);
        struct legend_row *row =
            add_row(out, say(out, is_plain ? "%.*f" : "%.*g", is_plain ? decimals : 4, low + part * (high - low)));
        row->mark = true;
        for (int k = 0; k < LEGEND_BAR && i; k++) {
            double at = part + (1 - (k + 0.5) / LEGEND_BAR) / (MARKS - 1);
            if (transfer) {
                transfer_part_colour(bars[i - 1][k], transfer, at);
            } else {
                tube_scalar_colour(bars[i - 1][k], at);
            }
        }
        row->bar = i ? (const uint8_t(*)[3])bars[i - 1] : NULL;
    }
}

/* Explains the colours of streamlines where these are not their bundles': a heading, and colours. */
static void add_streamlines(struct picture_legend *out, const struct picture *picture)
{
    static const char *const directions[] = {"left to right", "back to front", "down to up"};
    const struct tube_colouring *colouring = picture->streamlines;
    if (!colours_streamlines(picture)) {
        return;
    }
    add_row(out, say(out, "Streamlines by %.*s", TEXT_SIZE / 2,
                     colouring->by == TUBE_BY_DIRECTION ? "direction" : colouring->scalar))
        ->heading = true;
    if (colouring->by == TUBE_BY_SCALAR && colouring->low > colouring->high) {
        tube_scalar_colour(add_row(out, "not known")->rgb, NAN);
        return;
    }
    if (colouring->by == TUBE_BY_SCALAR) {
        add_bar(out, colouring->low, colouring->high, NULL);
        return;
    }
    bool has_points = false;
    for (size_t i = 0; i < picture->atlas->tractogram_count; i++) {
        const struct tractogram *tractogram = &picture->atlas->tractograms[i];
        for (size_t k = 0; k < tractogram->streamline_count && !has_points; k++) {
            has_points = tractogram->first[k + 1] - tractogram->first[k] == 1;
        }
    }
    for (int i = 0; i < 3; i++) {
        add_row(out, directions[i])->rgb[i] = 255;
    }
    if (has_points) {
        tube_direction_colour(add_row(out, "none: one point")->rgb, (const double[3]){0, 0, 0});
    }
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
static void add_map(struct picture_legend *out, const struct picture *picture)
{
    const struct context_surface *surface = atlas_mapped_surface(picture->atlas);
    if (surface) {
        char words[TEXT_SIZE];
        describe_map(words, surface->map_name);
        add_row(out, say(out, "%s", words))->heading = true;
        add_bar(out, surface->low, surface->high, NULL);
    }
}

static const char percent[] = "probability, %";

/* What the values of a map are. Where nothing says so they are no statistic if they are stored as whole numbers over
 * the range of a probability. */
static const char *unit_of(const conus_volume_info *info, const struct value_scale *scale)
{
    const bool is_whole = strncmp(info->datatype, "uint", 4) == 0 && info->slope == 1;
    const bool is_stated = strcmp(info->unit, "probability") == 0 && scale->is_probability;
    return is_stated || (!info->unit[0] && scale->is_probability && is_whole) ? percent
           : info->unit[0]                                                    ? info->unit
                                                                              : "value";
}

/* Explains the colours of haze by values: as values where they stand for the same ones in all such pathways, else as
 * parts of the way from where each pathway begins to its largest value. */
static void add_haze(struct picture_legend *out, const struct picture *picture)
{
    const struct transfer *first = NULL;
    const char *unit = NULL;
    const char *name = NULL;
    double span[2] = {0, 1};
    bool is_same = true;
    bool is_one_unit = true;
    char text[PICTURE_TEXT];
    for (uint32_t number = 1; number <= picture->atlas->object_count; number++) {
        if (!is_by_value(picture, number)) {
            continue;
        }
        const struct transfer *transfer = &picture->hazy->transfers[number];
        const struct volume *volume = atlas_object_volume(picture->atlas, number);
        struct value_spread spread = {0};
        value_spread_add(&spread, &volume->map, &volume->info);
        const struct value_scale scale = value_scale_of(&spread, &volume->info);
        const char *own_unit = unit_of(&volume->info, &scale);
        double factor = own_unit == percent && scale.is_probability ? 100 / scale.value : 1;
        const double ends[2] = {factor * transfer->points[0].value,
                                factor * transfer->points[transfer->count - 1].value};
        if (first) {
            is_one_unit = is_one_unit && strcmp(unit, own_unit) == 0;
            is_same = is_same && is_one_unit && fabs(ends[0] - span[0]) + fabs(ends[1] - span[1]) < 1e-6;
        } else {
            first = transfer;
            name = picture_name(text, picture, number);
            unit = own_unit;
            memcpy(span, ends, sizeof span);
        }
    }
    if (first) {
        const char *shared = !is_one_unit ? "value" : unit == percent ? "probability" : unit;
        const char *of = count_by_value(picture) == 1 ? name : "Pathways";
        add_row(out, say(out, "%s by %s%s", of, is_same ? unit : shared, is_same ? "" : ", % of range"))->heading =
            true;
        add_bar(out, is_same ? span[0] : 0, is_same ? span[1] : 100, first);
    }
}

/* Digits after the point with which a number was given; -1 = more than six: it was computed. */
static int digits_of(double value)
{
    for (int digits = 0; digits <= 6; digits++) {
        if (fabs(rint(value * pow(10, digits)) / pow(10, digits) - value) <= 1e-11 * (1 + fabs(value))) {
            return digits;
        }
    }
    return -1;
}

void picture_put_place(char out[PICTURE_NUMBER], double value, int most)
{
    const double parts = pow(10, most);
    double place = digits_of(value) >= 0 ? value : rint(value * parts) / parts;
    int digits = digits_of(place);
    double shown = rint(place * pow(10, digits)) / pow(10, digits);
    snprintf(out, PICTURE_NUMBER, "%.*f", digits, shown == 0 ? 0 : shown); /* no -0 */
}

/* The direction of its axis, in the space of the frame. */
static void describe_axis(char out[PICTURE_TEXT], const struct cone *cone, const conus_frame *frame)
{
    const double *m = cone->pose.world_from_device;
    double axis[3] = {-m[8], -m[9], -m[10]};
    if (frame) {
        conus_frame_direction_from_world(axis, frame, axis);
    }
    for (int a = 0; a < 3; a++) {
        axis[a] = rint(100 * axis[a]) / 100 + 0.0; /* no -0 */
    }
    snprintf(out, PICTURE_TEXT, "along %.4g, %.4g, %.4g", axis[0], axis[1], axis[2]);
}

void picture_describe_cone(char out[2][PICTURE_TEXT], const struct cone *cone, const conus_frame *frame)
{
    static const char *const places[] = {", RAS mm", ", LPS mm", " \u00b5m in CCF", " mm from bregma"};
    const conus_space space = frame ? frame->space : CONUS_SPACE_RAS;
    bool rod = cone->radius > 0;
    double at[3];
    memcpy(at, cone->pose.world_from_device + 12, sizeof at);
    if (frame) {
        conus_frame_from_world(at, frame, at);
    }
    char *line = out[0];
    int size = snprintf(line, PICTURE_TEXT, "%s%.4g%s from", rod ? "radius " : "", rod ? cone->radius : cone->degrees,
                        rod ? " mm" : "\u00b0");
    for (size_t a = 0; a < 3; a++) {
        const char *axis = space < CONUS_SPACE_CCF ? "" : conus_space_axis(space, a);
        char number[PICTURE_NUMBER];
        picture_put_place(number, at[a], space == CONUS_SPACE_CCF ? 1 : 3);
        size += snprintf(line + size, PICTURE_TEXT - (size_t)size, "%s %s%s%s", a ? "," : "", axis, *axis ? " " : "",
                         number);
    }
    snprintf(line + size, PICTURE_TEXT - (size_t)size, "%s", places[space]);
    describe_axis(out[1], cone, frame);
}

/* Object number `i` of the list: pathways and bundles, which are few and drawn over areas, before these; without a
 * cone, where it is known, what is seen most of what is not `done`, unless some have numbers. */
static uint32_t listed_at(const struct picture *picture, size_t i, const bool *done)
{
    const conus_atlas *atlas = picture->atlas;
    const bool by_seen = picture->seen && !picture->options.selection && count_by_value(picture) < 2;
    uint32_t best = 0;
    for (uint32_t n = 1; by_seen && n <= atlas->object_count; n++) {
        best = !done[n] && (!best || picture->seen[n] > picture->seen[best]) ? n : best;
    }
    return best ? best : (uint32_t)((atlas->area_count + i) % atlas->object_count + 1);
}

/* Adds what is listed though the cone does not hit it, areas of one level once. Those that are hit are marked in `done`
 * [object_count + 1]. */
static void add_listed(struct picture_legend *out, const struct picture *picture, bool *done)
{
    const conus_selection *selection = picture->options.selection;
    for (size_t i = 0; i < picture->atlas->object_count; i++) {
        uint32_t number = listed_at(picture, i, done);
        uint32_t shown = selection && selection->group ? selection->group[number] : number;
        bool was_done = done[shown];
        done[shown] = done[shown] || !selection || is_listed(picture, number);
        if (!was_done && is_listed(picture, number)) {
            add_object(out, picture, shown, picture_is_hidden(picture, shown))->detail[0] =
                selection ? "not hit" : NULL;
        }
    }
}

/* Adds the groups of points; of many the last in one row. */
static void add_groups(struct picture_legend *out, const struct picture *picture)
{
    const size_t count = picture_has_groups(picture) && !picture->has_group_scale ? picture->group_count : 0;
    const size_t shown = count > GROUP_ROWS ? GROUP_ROWS - 1 : count;
    if (count && out->legend.count) {
        add_row(out, "Points")->heading = true;
    }
    for (size_t i = 0; i < shown; i++) {
        const struct picture_group *group = &picture->groups[i];
        struct legend_row *row = add_row(out, group->name ? group->name : "others");
        memcpy(row->rgb, group->rgb, sizeof row->rgb);
        row->detail[0] = say(out, "%zu", group->count);
    }
    if (shown < count) {
        add_row(out, say(out, "and %zu other groups", count - shown))->plain = true;
    }
}

/* Explains the colours of points on a scale of numbers. */
static void add_point_scale(struct picture_legend *out, const struct picture *picture)
{
    const double *range = picture->group_range;
    if (!picture->has_group_scale) {
        return;
    }
    char words[TEXT_SIZE];
    describe_map(words, picture->options.group_title);
    add_row(out, say(out, "%s", words))->heading = true;
    add_bar(out, range[0], range[1], NULL);
    if (picture->has_unknown_group) {
        tube_scalar_colour(add_row(out, "not known")->rgb, NAN);
    }
}

static const char *title_of(const struct picture *picture)
{
    static const char *const titles[] = {NULL,
                                         "Areas",
                                         "Pathways",
                                         "Areas and pathways",
                                         "Bundles",
                                         "Areas and bundles",
                                         "Pathways and bundles",
                                         "Areas, pathways and bundles"};
    unsigned kinds = 0;
    bool is_any = false;
    for (uint32_t number = 1; number <= picture->atlas->object_count; number++) {
        const bool bundle = picture->atlas->objects[number - 1].kind == CONUS_KIND_BUNDLE;
        const struct volume *volume = atlas_object_volume(picture->atlas, number);
        const char *unit = volume ? volume->info.unit : "";
        const bool is_named =
            (volume && value_map_is_mask(&volume->map)) || (unit[0] && strcmp(unit, "probability") != 0);
        const unsigned kind = number <= picture->atlas->area_count ? 1 : bundle ? 4 : is_named ? 0 : 2;
        is_any = is_any || is_listed(picture, number);
        kinds |= is_listed(picture, number) ? kind : 0;
    }
    return is_any ? titles[kinds] : "Points"; /* a mask or map is no pathway: its name says what it is */
}

/* Leaves out rows of objects from number `kept` on, or only those behind others; one row says how many they are. */
static void leave_out(struct picture_legend *out, size_t kept, bool only_behind)
{
    struct legend_row *rows = out->rows;
    size_t seen = 0;
    size_t count = 0;
    size_t left_out = 0;
    struct legend_row *more = NULL;
    bool all_behind = true;
    for (size_t i = 0; i < out->legend.count; i++) {
        bool is_last = i >= out->legend.count - out->legend.tail;
        bool can_leave = !is_last && !rows[i].written && (only_behind ? rows[i].detail[0] == BEHIND : !rows[i].plain);
        if (!can_leave || seen++ < kept) {
            rows[count++] = rows[i];
            continue;
        }
        left_out++;
        all_behind = all_behind && rows[i].detail[0] == BEHIND;
        if (!more) {
            more = &rows[count++];
            *more = (struct legend_row){.plain = true};
        }
    }
    if (more) {
        more->name = say(out, left_out == 1 ? "and %zu other" : "and %zu others", left_out);
        more->detail[0] = all_behind ? BEHIND : NULL;
    }
    out->legend.count = count;
}

/* Leaves out rows whose names are in the picture. */
static void drop_written(struct picture_legend *out)
{
    struct legend_row *rows = out->rows + (out->legend.rows - out->rows);
    size_t count = 0;
    for (size_t i = 0; i < out->legend.count; i++) {
        rows[count] = rows[i];
        count += !rows[i].written;
    }
    out->legend.count = count;
}

/* Fills the rows: the hits of the cone, then what else the picture shows. CONUS_ERROR_MEMORY. */
static conus_status fill_rows(struct picture_legend *out, const struct picture *picture)
{
    const conus_selection *selection = picture->options.selection;
    bool *done = memory_zeroed(picture->atlas->object_count + 1, sizeof *done);
    if (!done) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object ? result->pixels || result->pierced : result->share >= NO_SHARE) {
            add_result(out, picture, result);
            done[result->object] = true;
        }
    }
    add_listed(out, picture, done);
    memory_free(done);
    if (selection) {
        add_pathways(out, picture);
    }
    add_left_out(out, picture);
    add_groups(out, picture);
    const size_t count = out->legend.count;
    if (count && conus_atlas_exchanged(picture->atlas)) { /* for whoever reads sides off the names */
        add_row(out, "left and right are exchanged")->plain = true;
    }
    add_map(out, picture); /* the bars of streamlines and of a map are of the same colours, with their own numbers */
    add_haze(out, picture);
    add_streamlines(out, picture);
    add_point_scale(out, picture);
    out->legend.rows = out->rows;
    out->legend.tail = out->legend.count - count;
    if (selection) {
        char subtitle[2][PICTURE_TEXT];
        const struct wording *words = wording_of(&picture->options);
        const char *title = selection->has_layers ? words->all : words->first;
        const char *own = picture->options.title;
        picture_describe_cone(subtitle, &selection->cone, picture->options.frame);
        out->legend.title = own ? say(out, "%s: %c%s", own, tolower((unsigned char)title[0]), title + 1) : title;
        for (int n = 0; n < 2; n++) {
            out->legend.subtitle[n] = say(out, "%s", subtitle[n]);
        }
        int column = 0;
        if (words->has_share) {
            out->legend.header[column++] = "share";
        }
        out->legend.header[column++] = words->place[selection->has_layers];
        out->legend.header[column] = words->has_length && selection->has_layers ? "for" : NULL;
    } else if (count) {
        out->legend.title = title_of(picture);
    } else if (out->legend.tail) { /* without a cone, the heading of the colours is the title */
        out->legend.title = out->rows[0].name;
        out->legend.rows++;
        out->legend.count--;
        out->legend.tail = 0;
    }
    if (picture->options.legend_rows && count) {
        leave_out(out, picture->options.legend_rows, false);
    }
    return CONUS_OK;
}

/* Shortens the list to `capacity` rows: the last objects that are only behind others leave, and one row says how many
 * they are. Where that is not enough, all stay, and legend_draw() counts what it leaves out. */
static void leave_out_behind(struct picture_legend *out, size_t capacity)
{
    size_t behind = 0;
    for (size_t i = 0; i < out->legend.count; i++) {
        behind += out->legend.rows[i].detail[0] == BEHIND && !out->legend.rows[i].plain;
    }
    size_t surplus = out->legend.count + 1 - capacity; /* the row that says so takes a line, too */
    if (behind >= surplus) {
        leave_out(out, behind - surplus, true);
    }
}

/* Chooses the letters' size, the columns, up to `columns`, and the rows for so many pixels, and measures the legend.
 * Where not all rows fit, more columns are tried before any is left out. */
static void fit(struct picture_legend *legend, const struct picture *picture, const double limit[2], size_t columns)
{
    struct legend *drawn = &legend->legend;
    const double em = picture->em;
    drawn->columns = columns;
    legend_fit(legend->size, drawn, picture->font, limit, em, SMALLEST * em);
    if (columns == 1 && legend->size[1] > limit[1]) {
        drawn->columns = LEGEND_COLUMNS;
        legend_fit(legend->size, drawn, picture->font, limit, em, SMALLEST * em);
    }
    size_t capacity = legend_capacity(drawn, limit[1]);
    if (drawn->count > capacity) {
        leave_out_behind(legend, capacity);
        legend_fit(legend->size, drawn, picture->font, limit, drawn->size, drawn->size);
    }
    if (legend->size[0] > limit[0]) { /* a long name has smaller letters yet */
        const double width[2] = {limit[0], INFINITY};
        legend_fit(legend->size, drawn, picture->font, width, drawn->size, 1);
    }
}

/* Where nobody said where it stands: beside a drawing that is wide enough, and where an off-axis camera has made one of
 * this shape below it. */
static bool stands_right(struct picture_legend *legend, const struct picture *picture)
{
    const conus_view *options = &picture->options;
    const double width[2] = {SLIM * options->width, INFINITY};
    if (options->legend != CONUS_LEGEND_AUTO) {
        return options->legend == CONUS_LEGEND_RIGHT;
    }
    legend_fit(legend->size, &legend->legend, picture->font, width, picture->em, picture->em);
    return !picture->is_low && legend->size[0] <= width[0] && options->width > options->height &&
           !(options->frustum[0] < options->frustum[1]);
}

/* Makes one line of the subtitle's where that is not wider than so many pixels. */
static void join_subtitle(struct picture_legend *legend, const struct picture *picture, double width)
{
    static const double any[2] = {INFINITY, INFINITY};
    struct legend joined = legend->legend;
    double size[2];
    if (!joined.subtitle[1]) {
        return;
    }
    joined.subtitle[0] = say(legend, "%s %s", joined.subtitle[0], joined.subtitle[1]);
    joined.subtitle[1] = NULL;
    joined.count = joined.tail = 0;
    legend_fit(size, &joined, picture->font, any, picture->em, picture->em);
    if (size[0] <= width) {
        memcpy(legend->legend.subtitle, joined.subtitle, sizeof joined.subtitle);
    }
}

/* Takes place for it from the drawing on the right, or adds some below. */
static void place(struct picture_legend *legend, struct picture *picture)
{
    const bool right = legend->is_right = stands_right(legend, picture);
    const double sheet[2] = {picture->options.width, picture->options.height};
    const double high = right ? 1 : picture->options.print ? BELOW_IN_PRINT : BELOW;
    const double limit[2] = {(right ? BESIDE : 1) * sheet[0], floor(high * sheet[1])};
    struct legend *drawn = &legend->legend;
    if (!right) {
        join_subtitle(legend, picture, limit[0]);
    }
    fit(legend, picture, limit, right ? 1 : (drawn->count + LEAST_ROWS - 1) / LEAST_ROWS);
    double width = fmin(ceil(legend->size[0]), right ? sheet[0] - 1 : sheet[0]);
    double height = fmin(ceil(legend->size[1]), limit[1]);
    if (right) {
        picture->drawing[0] -= (uint32_t)width;
        drawn->at[0] = picture->drawing[0];
    } else {
        drawn->at[1] = picture->drawing[1];
        picture->sheet_height += (uint32_t)height;
    }
    drawn->ink = picture->ink;
    drawn->faint = (double)picture->dim;
}

/* Whether all that the legend would say is the name of the only area, which has one colour. */
static bool is_plain(const struct picture *picture)
{
    const conus_view *options = &picture->options;
    return options->legend == CONUS_LEGEND_AUTO && !options->selection && picture->atlas->object_count == 1 &&
           picture->atlas->area_count == 1 && picture->legend->legend.count == 1 && !picture->legend->legend.tail;
}

/* Appends "Precentral_L (#00A0A8): share 7.3 %, distance 28.2 mm", or of a bar its ends. */
static void describe_row(struct buffer *out, const struct legend *legend, size_t index)
{
    const struct legend_row *row = &legend->rows[index];
    const struct legend_row *next = index + 1 < legend->count && row[1].mark ? row + 1 : NULL;
    const bool is_inside_bar = row->mark && row->bar && next;
    const uint8_t *rgb = !row->mark ? row->rgb : row->bar ? row->bar[LEGEND_BAR - 1] : next ? next->bar[0] : row->rgb;
    const char *joint = ": ";
    if (is_inside_bar) {
        return;
    }
    buffer_text(out, row->own ? row->own : row->name);
    if (row->ramp) {
        buffer_text(out, " (coloured as below)");
    } else if (!row->plain && !row->heading && !row->bare) {
        buffer_format(out, " (#%02X%02X%02X%s)", rgb[0], rgb[1], rgb[2], row->striped ? ", striped" : "");
    }
    for (int d = 0; d < LEGEND_DETAILS; d++) {
        const char *head = legend->header[d];
        if (row->detail[d]) {
            const bool has_head = head && row->detail[d][0] >= '0' && row->detail[d][0] <= '9';
            buffer_format(out, "%s%s%s%s", joint, has_head ? head : "", has_head ? " " : "", row->detail[d]);
            joint = ", ";
        }
    }
    buffer_text(out, row->heading ? ":\n" : "\n");
}

/* The legend in words, before rows leave for want of place: what it is of, a line each row, and what is drawn in grey.
 */
static conus_status describe(struct picture *picture)
{
    const struct legend *legend = &picture->legend->legend;
    struct buffer out = {0};
    if (legend->title) {
        buffer_text(&out, legend->title);
        for (int n = 0; n < LEGEND_SUBTITLES; n++) {
            if (legend->subtitle[n]) {
                buffer_format(&out, "%s%s", n ? ", " : ": ", legend->subtitle[n]);
            }
        }
        buffer_text(&out, "\n");
    }
    for (size_t i = 0; i < legend->count; i++) {
        describe_row(&out, legend, i);
    }
    const char *before = "Grey, not hit: ";
    for (uint32_t n = (uint32_t)picture->atlas->area_count + 1; n <= picture->atlas->object_count; n++) {
        if (picture->options.selection && picture->emphasis[n] == EMPHASIS_PALE && picture_draws(picture, n) &&
            !is_listed(picture, n) && !is_entered(picture, n)) {
            buffer_format(&out, "%s%s", before, picture->atlas->objects[n - 1].name);
            before = ", ";
        }
    }
    buffer_text(&out, before[0] == ',' ? "\n" : "");
    conus_status status = buffer_status(&out);
    if (status) {
        buffer_finish(&out);
        return status;
    }
    picture->key = out.data;
    return CONUS_OK;
}

conus_status picture_add_key(conus_image *image, const struct picture *picture)
{
    return picture->key && picture->key[0] ? image_add_text(image, IMAGE_LEGEND, picture->key) : CONUS_OK;
}

void picture_legend_finish(struct picture *picture)
{
    struct picture_legend *legend = picture->legend;
    for (size_t i = 0; legend && i < legend->text_count; i++) {
        memory_free(legend->texts[i]);
    }
    if (legend) {
        memory_free(legend->texts);
        memory_free(legend->rows);
    }
    memory_free(legend);
    picture->legend = NULL;
}

conus_status picture_legend_init(struct picture *picture)
{
    size_t results = conus_selection_count(picture->options.selection);
    size_t most = results + picture->atlas->object_count + OTHER_ROWS;
    if (!has_meaning(picture)) {
        return CONUS_OK;
    }
    struct picture_legend *legend = picture->legend = memory_zeroed(1, sizeof *legend);
    if (legend) {
        legend->rows = memory_zeroed(most + 1 + GROUP_ROWS + 1 + KEYS * COLOUR_ROWS, sizeof *legend->rows);
    }
    if (!legend || !legend->rows) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = fill_rows(legend, picture);
    status = status || legend->failed ? CONUS_ERROR_MEMORY : describe(picture);
    drop_written(legend);
    if (!status && legend->legend.count && picture->options.legend != CONUS_LEGEND_NONE && !is_plain(picture)) {
        if (picture->options.print) { /* on paper the caption has them */
            legend->legend.subtitle[0] = legend->legend.subtitle[1] = NULL;
        }
        place(legend, picture);
        return legend->failed ? CONUS_ERROR_MEMORY : CONUS_OK;
    }
    if (!status) {
        picture_legend_finish(picture);
    }
    return status;
}

void picture_lower(struct picture *picture, uint32_t height)
{
    struct picture_legend *legend = picture->legend;
    uint32_t beside = legend && legend->is_right ? (uint32_t)ceil(legend->size[1]) : 0;
    uint32_t lowered = height < picture->drawing[1] ? height : picture->drawing[1];
    if (legend && !legend->is_right) {
        legend->legend.at[1] = lowered;
        picture->sheet_height -= picture->drawing[1] - lowered;
    } else {
        picture->sheet_height = lowered > beside ? lowered : beside;
    }
    picture->drawing[1] = lowered;
}

double picture_covered(const struct picture *picture, const struct draw_box *box)
{
    const uint32_t *drawing = picture->drawing;
    const long left = lrint(fmax(floor(box->left), 0));
    const long right = lrint(fmin(ceil(box->right), drawing[0]));
    const long top = lrint(fmax(floor(box->top), 0));
    const long bottom = lrint(fmin(ceil(box->bottom), drawing[1]));
    double sum = 0;
    for (long y = top; y < bottom; y++) {
        for (long x = left; x < right; x++) {
            sum += (double)picture->rgba[4 * ((size_t)(drawing[1] - 1 - y) * drawing[0] + (size_t)x) + 3];
        }
    }
    return sum;
}

void picture_legend_draw(struct draw_list *list, const struct picture *picture)
{
    legend_draw(list, picture->font, &picture->legend->legend);
}
