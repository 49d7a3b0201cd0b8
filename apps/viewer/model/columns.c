/* SPDX-License-Identifier: BSD-3-Clause */
/* A table of columns: where each value lies in a result, and how it is written; files of results. */
#include "viewer/model/columns.h"

#include "base/order.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum kind { TEXT_NAME, TEXT_ABBREVIATION, LABEL, COUNT, LONG_COUNT, NUMBER, PART, PLACE };

struct column {
    const char *key, *heading, *unit, *meaning;
    enum kind kind;
    size_t offset; /* in the result */
    int digits;    /* of conus query's table */
    const char *widest;
    bool falls;        /* the largest value comes first */
    bool needs_object; /* the row of what is unassigned has no value */
};

#define AT(member) offsetof(conus_result, member)

static const struct column columns[RESULT_COLUMNS] = {
    [RESULT_RANK] = {"rank", "rank", NULL, "1 is the best score", COUNT, AT(rank), 0, "999", .needs_object = true},
    [RESULT_NAME] = {"name", "area", NULL, "name of the area, pathway or bundle", TEXT_NAME, .widest = ""},
    [RESULT_ABBREVIATION] = {"abbreviation", "short", NULL, "abbreviation in the label table", TEXT_ABBREVIATION,
                             .widest = "VISpm2/3"},
    [RESULT_LABEL] = {"index", "label", NULL,
                      "the atlas's own label of the area, or the ordinal of the pathway or bundle", LABEL,
                      .widest = "4294967295"},
    [RESULT_SHARE] = {"share", "share", NULL, "its part, by what is hit first, in % of the", PART, AT(share), 1,
                      "100.0 %", .falls = true},
    [RESULT_SCORE] = {"score", "score", NULL, "value of the chosen score, higher is better", NUMBER, AT(score), 4,
                      "-9999.9999", .falls = true},
    [RESULT_PIXELS] = {"pixels", "pixels", "pixels", "pixels of the cone that hit it first", COUNT, AT(pixels), 0,
                       "1048576", .falls = true},
    [RESULT_DISTANCE] = {"distance_mm", "distance mm", "mm", "distance from the start to its nearest first hit", NUMBER,
                         AT(distance), 2, "9999.99"},
    [RESULT_ENTRY] = {"entry_mm", "entry mm", "mm from the start", "nearest entry over all layers", NUMBER, AT(entry),
                      2, "999.99", .needs_object = true},
    [RESULT_EXIT] = {"exit_mm", "exit mm", "mm from the start", "farthest exit over all layers", NUMBER, AT(exit), 2,
                     "999.99", .needs_object = true},
    [RESULT_PATH] = {"path_mm", "inside mm", "mm", "mean length of its rays inside it", NUMBER, AT(path), 2, "999.99",
                     .falls = true, .needs_object = true},
    [RESULT_OFFSET] = {"offset_deg", "off axis \u00b0", "degrees", "smallest angle between its rays and the axis",
                       NUMBER, AT(offset), 2, "89.99"},
    [RESULT_X] = {"contact_x", "", "", "where the ray nearest to the axis enters it, first coordinate", PLACE,
                  AT(contact), 0, ""},
    [RESULT_Y] = {"contact_y", "", "", "the same, second coordinate", PLACE, AT(contact), 1, ""},
    [RESULT_Z] = {"contact_z", "", "", "the same, third coordinate", PLACE, AT(contact), 2, ""},
    [RESULT_CONTACT_VALUE] = {"contact_value", "at contact", NULL,
                              "value of the voxel at the contact, of a pathway, or probability there", NUMBER,
                              AT(contact_value), 4, "-99999.9999", .falls = true},
    [RESULT_PIERCED] = {"pierced", "pierced", "pixels", "pixels whose ray passes it, occluded or not", COUNT,
                        AT(pierced), 0, "1048576", .falls = true, .needs_object = true},
    [RESULT_VOLUME] = {"volume_mm3", "volume mm\u00b3", "mm\u00b3", "its volume inside the cone", NUMBER, AT(volume), 1,
                       "9999999.9", .falls = true},
    [RESULT_FRACTION] = {"fraction", "of whole", "% of the area", "that volume as a part of its whole", PART,
                         AT(fraction), 2, "100.00 %", .falls = true, .needs_object = true},
    [RESULT_MEAN] = {"mean_value", "mean", NULL, "mean value of its voxels in the cone, of a pathway or a probability",
                     NUMBER, AT(mean_value), 4, "-99999.9999", .falls = true, .needs_object = true},
    [RESULT_MAX] = {"max_value", "largest", NULL, "largest value of its voxels in the cone, likewise", NUMBER,
                    AT(max_value), 4, "-99999.9999", .falls = true, .needs_object = true},
    [RESULT_STREAMLINES] = {"streamlines", "lines", NULL, "streamlines of the bundle that come into the cone",
                            LONG_COUNT, AT(streamlines), 0, "9999999", .falls = true, .needs_object = true},
    [RESULT_LENGTH] = {"length_mm", "length mm", "mm", "length of the parts of its streamlines in the cone", NUMBER,
                       AT(length), 1, "9999999.9", .falls = true, .needs_object = true},
    [RESULT_ALONG] = {"along", "along", "0 to 1", "how far along the bundle the nearest of these parts is", NUMBER,
                      AT(along), 2, "0.99", .needs_object = true},
};

const char *const result_formats[RESULT_FORMATS] = {"TSV", "CSV", "JSON"};
const char *const result_endings[RESULT_FORMATS] = {".tsv", ".csv", ".json"};

const char *result_key(size_t column)
{
    return columns[column].key;
}

size_t result_find(const char *key)
{
    size_t column = 0;
    while (column < RESULT_COLUMNS && strcmp(columns[column].key, key) != 0) {
        column++;
    }
    return column;
}

const char *result_heading(const struct viewer *viewer, size_t column)
{
    const struct column *of = &columns[column];
    return of->kind == PLACE ? conus_space_axis(viewer->frame.space, (size_t)of->digits) : of->heading;
}

const char *result_meaning(char out[RESULT_TIP], const struct viewer *viewer, size_t column)
{
    const char *unit = columns[column].kind == PLACE ? conus_space_unit(viewer->frame.space) : columns[column].unit;
    snprintf(out, RESULT_TIP, "%s: %s%s%s", columns[column].key, columns[column].meaning,
             column == RESULT_SHARE ? " "
             : unit                 ? ", "
                                    : "",
             column == RESULT_SHARE ? viewer_shape(viewer)
             : unit                 ? unit
                                    : "");
    return out;
}

bool result_is_text(size_t column)
{
    return columns[column].kind <= TEXT_ABBREVIATION;
}

const char *result_widest(const struct viewer *viewer, size_t column)
{
    static const char *const places[] = {"-199.99", "-199.99", "13200.0", "-19.99"}; /* by space */
    return columns[column].kind == PLACE ? places[viewer->frame.space] : columns[column].widest;
}

static bool has_layers(const struct viewer *viewer)
{
    return viewer->cone.options.layers == CONUS_LAYERS_ALL && !viewer->cone.one_ray;
}

bool result_is_offered(const struct viewer *viewer, size_t column)
{
    bool of_layers = column >= RESULT_PIERCED || (column >= RESULT_ENTRY && column <= RESULT_PATH);
    bool of_bundles = column >= RESULT_STREAMLINES;
    bool has_bundles = false;
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        has_bundles = has_bundles || conus_atlas_tractogram_count(viewer->atlases[i].atlas);
    }
    return (!of_layers || has_layers(viewer)) && (!of_bundles || has_bundles);
}

static uint32_t bit(size_t column)
{
    return UINT32_C(1) << column;
}

/* The columns that were chosen, or else the usual ones: with all layers the entry, which occluded areas have, too. */
static uint32_t chosen(const struct viewer *viewer)
{
    if (viewer->list.columns) {
        return viewer->list.columns;
    }
    const char *score = viewer->cone.options.score;
    bool has_score = score && strcmp(score, "share") != 0; /* which is there already */
    return bit(RESULT_NAME) | bit(RESULT_SHARE) | bit(has_layers(viewer) ? RESULT_ENTRY : RESULT_DISTANCE) |
           bit(RESULT_X) | bit(RESULT_Y) | bit(RESULT_Z) | (has_score ? bit(RESULT_SCORE) : 0);
}

size_t result_shown(size_t out[RESULT_COLUMNS], const struct viewer *viewer)
{
    static const size_t first = RESULT_NAME; /* it scrolls to no side */
    size_t count = 0;
    out[count++] = first;
    for (size_t i = 0; i < RESULT_COLUMNS; i++) {
        if (i != first && (chosen(viewer) & bit(i)) && result_is_offered(viewer, i)) {
            out[count++] = i;
        }
    }
    return count;
}

void result_show(struct viewer *viewer, size_t column, bool shown)
{
    uint32_t others = chosen(viewer) & ~bit(column);
    viewer->list.columns = others | bit(RESULT_NAME) | (shown ? bit(column) : 0);
    viewer->version++;
}

bool result_choose(struct viewer *viewer, char *const *keys, size_t count)
{
    uint32_t wanted = count ? bit(RESULT_NAME) : 0;
    bool fine = true;
    for (size_t i = 0; i < count && fine; i++) {
        size_t column = result_find(keys[i]);
        fine = column < RESULT_COLUMNS;
        wanted |= fine ? bit(column) : 0;
    }
    if (fine) {
        viewer->list.columns = wanted;
        viewer->version++;
    }
    return fine;
}

void result_order_by(struct viewer *viewer, size_t column)
{
    struct result_list *list = &viewer->list;
    bool again = list->order == column;
    list->order = again && list->reversed ? RESULT_RANK : column;
    list->reversed = again && !list->reversed;
    viewer->version++;
}

/* NULL where there is none. */
static const char *text_of(const struct view_atlas *view, const struct column *of, const conus_result *result)
{
    const conus_object *object = conus_atlas_object(view->atlas, result->object);
    if (of->kind == TEXT_NAME) {
        return object ? object->name : "(nothing hit)";
    }
    return object && object->abbreviation && object->abbreviation[0] ? object->abbreviation : NULL;
}

static double number_at(const conus_result *result, const struct column *of)
{
    const void *at = (const char *)result + of->offset;
    return of->kind == COUNT        ? (double)*(const uint32_t *)at
           : of->kind == LONG_COUNT ? (double)*(const uint64_t *)at
                                    : *(const double *)at;
}

/* In the unit of conus query's tables; NaN where there is none. */
static double value_of(const struct viewer *viewer, const struct view_atlas *view, const struct column *of,
                       const conus_result *result)
{
    double place[3];
    const conus_object *object = conus_atlas_object(view->atlas, result->object);
    bool of_bundles = (size_t)(of - columns) >= RESULT_STREAMLINES;
    if ((of->needs_object && !object) || (of_bundles && object->kind != CONUS_KIND_BUNDLE) ||
        !result_is_offered(viewer, (size_t)(of - columns))) {
        return NAN;
    }
    switch (of->kind) {
    case LABEL:
        return object ? (double)object->label : (double)NAN;
    case PLACE:
        conus_frame_from_world(place, &viewer->frame, result->contact);
        return place[of->digits];
    default:
        return number_at(result, of);
    }
}

void headline_share(char out[SHARE_TEXT], double share)
{
    const bool is_fine = share < 0.01 || (share > 0.99 && share < 1); /* what is not all is not 100 % */
    char part[TEXT_SHARE_SIZE];
    snprintf(out, SHARE_TEXT, "%s %%", text_share(part, share < 1 ? fmin(share, 0.999) : 1, is_fine));
}

const char *result_cell(char out[RESULT_TEXT], const struct viewer *viewer, const struct view_atlas *view,
                        size_t column, const conus_result *result)
{
    const struct column *of = &columns[column];
    if (result_is_text(column)) {
        const char *text = text_of(view, of, result);
        return text ? text : "-";
    }
    double value = value_of(viewer, view, of, result);
    if (column == RESULT_SHARE && result->object && !result->pixels && !viewer->tools[FIRST_TOOL].is_point) {
        snprintf(out, RESULT_TEXT, "behind"); /* others, with all layers */
    } else if (!isfinite(value)) {
        snprintf(out, RESULT_TEXT, "-");
    } else if (of->kind == PART) {
        char part[TEXT_SHARE_SIZE];
        snprintf(out, RESULT_TEXT, "%s %%", text_share(part, value, of->digits));
    } else { /* as conus query's table: a hundredth of a mm, but a tenth of a micrometre */
        int digits = of->kind != PLACE ? of->digits : viewer->frame.space == CONUS_SPACE_CCF ? 1 : 2;
        snprintf(out, RESULT_TEXT, "%.*f", digits, value);
    }
    return out;
}

const char *result_exact(char out[RESULT_TEXT], const struct viewer *viewer, const struct view_atlas *view,
                         size_t column, const conus_result *result)
{
    const struct column *of = &columns[column];
    if (result_is_text(column)) {
        const char *text = text_of(view, of, result);
        return text ? text : "n/a";
    }
    double value = value_of(viewer, view, of, result);
    bool is_whole = fabs(value) < 0x1p53 && value == floor(value);
    if (!isfinite(value)) {
        return "n/a";
    }
    snprintf(out, RESULT_TEXT, is_whole ? "%.0f" : "%.9g", value + 0.0); /* no -0 */
    return out;
}

struct row {
    size_t index;
    const char *text; /* NULL of numbers */
    double value;
    bool is_unassigned;
};

static int compare_values(const struct row *a, const struct row *b)
{
    if (a->text && b->text) {
        return strcmp(a->text, b->text);
    }
    return (a->value > b->value) - (a->value < b->value);
}

static bool is_missing(const struct row *row)
{
    return !row->text && isnan(row->value);
}

static int compare_rows(const void *left, const void *right, void *falls)
{
    const struct row *a = left;
    const struct row *b = right;
    int order = a->is_unassigned - b->is_unassigned;
    order = order ? order : is_missing(a) - is_missing(b);
    return order ? order : *(bool *)falls ? compare_values(b, a) : compare_values(a, b);
}

size_t *result_order(const struct viewer *viewer, const struct view_atlas *view, const conus_selection *selection)
{
    const struct result_list *list = &viewer->list;
    bool by_depth = list->order == RESULT_RANK && !list->reversed && viewer->cone.order == CONUS_ORDER_DEPTH;
    size_t column = !by_depth ? list->order : has_layers(viewer) ? RESULT_ENTRY : RESULT_DISTANCE;
    const struct column *of = &columns[column];
    bool falls = of->falls != list->reversed;
    size_t count = conus_selection_count(selection);
    struct row *rows = calloc(count + 1, sizeof *rows);
    size_t *order = calloc(count + 1, sizeof *order);
    if (!rows || !order) {
        free(rows);
        free(order);
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        bool is_text = result_is_text(column);
        rows[i] = (struct row){.index = i,
                               .text = is_text ? text_of(view, of, result) : NULL,
                               .value = is_text ? NAN : value_of(viewer, view, of, result),
                               .is_unassigned = !result->object};
    }
    order_sort_by(rows, count, sizeof *rows, compare_rows, &falls);
    for (size_t i = 0; i < count; i++) {
        order[i] = rows[i].index;
    }
    free(rows);
    return order;
}

bool export_results(struct viewer *viewer, const char *path, char why[EXPORT_WHY])
{
    const char *format;
    if (!output_format(&format, path)) {
        snprintf(why, EXPORT_WHY, "%s ends in none of .tsv, .csv and .json", path);
        return false;
    }
    const struct provenance provenance = {0};
    conus_report **reports = calloc(viewer->atlas_count, sizeof(conus_report *));
    char *sidecar = format_is(format, "json") ? NULL : provenance_path(path); /* JSON is its own */
    bool whole = reports && (sidecar || format_is(format, "json"));
    messages_hold(true);
    conus_status status = whole ? viewer_report(reports, viewer, FIRST_TOOL, format) : CONUS_ERROR_MEMORY;
    int code = status ? print_status(status) : answer_write(reports[0], path, sidecar, &provenance);
    messages_hold(false);
    free(sidecar);
    for (size_t i = 0; reports && i < viewer->atlas_count; i++) {
        conus_report_destroy(reports[i]);
    }
    free((void *)reports);
    if (code) {
        snprintf(why, EXPORT_WHY, "%s", error_line());
    }
    return !code;
}
