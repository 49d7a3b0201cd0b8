/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts streamlines by the areas at their ends (Eq. 20). */
#include "selection/connectivity/connectivity.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/threads.h"
#include "selection/measure/measure.h"
#include "selection/selection.h"

#include <math.h>
#include <stddef.h>

static const double RADIUS_LIMIT = 100;

/* A streamline as one of a bundle's. */
struct ended {
    uint32_t bundle;
    uint32_t a, b; /* areas as they are reported, less 1; those without one come last, as area_count */
    uint32_t streamline;
    uint32_t tractogram;
};

/* Streamlines whose ends are in the same two areas: a row of the table. Its object is the bundle; of all bundles, none.
 */
struct row {
    struct table_object object;
    uint32_t a, b;           /* areas as they are reported; 0 = none */
    uint32_t area_a, area_b; /* their rows in the list of areas */
    uint64_t streamlines;
    double fraction; /* they as a part of the bundle's streamlines that were looked at; these sum to 1 */
    double length;   /* their mean length, mm, in or out of the cone */
};

struct rows {
    struct row *at;
    size_t count;
};

struct connecting {
    conus_selector *selector;
    const struct table_question *asked;
    const struct region *region; /* NULL = everywhere */
    struct area_search search;
    struct ended *all;
    size_t count, capacity;
    struct ended *sorting; /* [count] */
    size_t bundle_count;   /* of those that have streamlines here */
    size_t pieces;         /* for threads */
    uint32_t *row_of;      /* [areas of the atlas + 1] among those of the matrix */
};

static uint32_t area_of_point(const struct connecting *connecting, const struct tractogram *tractogram, uint64_t index)
{
    const uint32_t *group = level_group(connecting->selector->level);
    double point[3];
    tractogram_point(point, tractogram, index);
    uint32_t area = group[area_at(&connecting->search, point)];
    return area ? area - 1 : (uint32_t)connecting->selector->atlas->area_count;
}

static void end_streamline(struct ended *ended, const struct connecting *connecting)
{
    const conus_atlas *atlas = connecting->selector->atlas;
    const struct tractogram *tractogram = &atlas->tractograms[ended->tractogram];
    uint64_t first = tractogram->first[ended->streamline];
    uint64_t end = tractogram->first[ended->streamline + 1];
    ended->a = ended->b = (uint32_t)atlas->area_count;
    if (end > first) {
        uint32_t from = area_of_point(connecting, tractogram, first);
        uint32_t to = end - first > 1 ? area_of_point(connecting, tractogram, end - 1) : from;
        ended->a = from < to ? from : to;
        ended->b = from < to ? to : from;
    }
}

/* A thread's part of all streamlines. */
static void end_piece(void *user, size_t piece)
{
    const struct connecting *connecting = user;
    size_t end = threads_begin(piece + 1, connecting->pieces, connecting->count, 1);
    for (size_t i = threads_begin(piece, connecting->pieces, connecting->count, 1); i < end; i++) {
        end_streamline(&connecting->all[i], connecting);
    }
}

/* Streamlines of a bundle, ascending. */
struct members {
    const uint32_t *numbers; /* NULL = from 0 on */
    size_t count;
    uint32_t *owned;
};

static conus_status list_members(struct members *out, const struct connecting *connecting, uint32_t bundle)
{
    const conus_atlas *atlas = connecting->selector->atlas;
    const struct tract_group *group = atlas_bundle_group(atlas, bundle);
    *out = (struct members){.numbers = group ? group->members : NULL,
                            .count = tract_group_count(group, atlas_bundle_tractogram(atlas, bundle))};
    if (!connecting->region) {
        return CONUS_OK;
    }
    conus_status status = tract_census_list(&out->owned, &out->count, atlas, bundle, connecting->region);
    out->numbers = out->owned;
    return status;
}

static conus_status add_members(struct connecting *connecting, uint32_t bundle, const struct members *members)
{
    const conus_atlas *atlas = connecting->selector->atlas;
    size_t index = (size_t)(atlas_bundle_tractogram(atlas, bundle) - atlas->tractograms);
    if (!memory_reserve(&connecting->all, &connecting->capacity, connecting->count + members->count,
                        sizeof *connecting->all)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < members->count; i++) {
        connecting->all[connecting->count++] =
            (struct ended){.bundle = bundle,
                           .streamline = members->numbers ? members->numbers[i] : (uint32_t)i,
                           .tractogram = (uint32_t)index};
    }
    connecting->bundle_count += members->count > 0;
    return CONUS_OK;
}

/* Lists all streamlines, bundle by bundle. */
static conus_status gather(struct connecting *connecting)
{
    const conus_atlas *atlas = connecting->selector->atlas;
    conus_status status = CONUS_OK;
    for (size_t i = atlas->area_count; i < atlas->object_count && !status; i++) {
        if (atlas->places[i].is_bundle && !atlas->places[i].is_hidden) {
            struct members members;
            status = list_members(&members, connecting, (uint32_t)i + 1);
            status = status ? status : add_members(connecting, (uint32_t)i + 1, &members);
            memory_free(members.owned);
        }
    }
    return status;
}

/* Finds their ends. */
static conus_status find_ends(struct connecting *connecting, double radius)
{
    enum { LEAST = 4096 }; /* streamlines for which a thread is worth while */
    conus_status status =
        area_search_init(&connecting->search, connecting->selector->atlas, radius, 2 * connecting->count);
    connecting->sorting = status ? NULL : memory_raw(connecting->count, sizeof *connecting->sorting);
    if (!connecting->sorting) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    connecting->pieces = threads_for(connecting->count, LEAST);
    threads_run(end_piece, connecting, connecting->pieces);
    return CONUS_OK;
}

static uint32_t key_of(const struct ended *ended, size_t offset)
{
    return *(const uint32_t *)((const char *)ended + offset);
}

/* Sorts by the number at this offset, digit by digit; those with equal ones stay in their order. */
static void sort_by(struct connecting *connecting, size_t offset)
{
    enum { DIGITS = 256, BITS = 8 };
    for (unsigned shift = 0; shift < 32; shift += BITS) {
        size_t begin[DIGITS] = {0};
        size_t next = 0;
        size_t most = 0;
        for (size_t i = 0; i < connecting->count; i++) {
            begin[key_of(&connecting->all[i], offset) >> shift & (DIGITS - 1)]++;
        }
        for (size_t digit = 0; digit < DIGITS; digit++) {
            size_t count = begin[digit];
            most = count > most ? count : most;
            begin[digit] = next;
            next += count;
        }
        if (most == connecting->count) {
            continue; /* they are sorted already: their digits are equal */
        }
        for (size_t i = 0; i < connecting->count; i++) {
            const struct ended *ended = &connecting->all[i];
            connecting->sorting[begin[key_of(ended, offset) >> shift & (DIGITS - 1)]++] = *ended;
        }
        struct ended *sorted = connecting->sorting;
        connecting->sorting = connecting->all;
        connecting->all = sorted;
    }
}

/* The most streamlines first; areas less 1, as in struct ended. */
static int by_count(const void *a, const void *b)
{
    const struct row *x = a;
    const struct row *y = b;
    int order = compare_unsigned(x->object.number, y->object.number);
    order = order ? order : compare_unsigned(y->streamlines, x->streamlines);
    order = order ? order : compare_unsigned(x->a - 1, y->a - 1);
    return order ? order : compare_unsigned(x->b - 1, y->b - 1);
}

/* Whether two sorted streamlines connect the same areas. */
static bool are_alike(const struct ended *a, const struct ended *b)
{
    return a->bundle == b->bundle && a->a == b->a && a->b == b->b;
}

/* Adds the connections of one bundle, which has `whole` streamlines. Returns the end of the rows. */
static struct row *add_kinds(struct row *out, const struct connecting *connecting, const struct ended *all,
                             size_t whole)
{
    const conus_atlas *atlas = connecting->selector->atlas;
    for (size_t first = 0; first < whole;) {
        size_t end = first;
        double length = 0;
        for (; end < whole && are_alike(&all[end], &all[first]); end++) {
            length += tractogram_length(&atlas->tractograms[all[end].tractogram], all[end].streamline);
        }
        uint32_t a = all[first].a < atlas->area_count ? all[first].a + 1 : 0;
        uint32_t b = all[first].b < atlas->area_count ? all[first].b + 1 : 0;
        *out++ = (struct row){.object = {CONUS_KIND_BUNDLE, all[first].bundle},
                              .a = a,
                              .b = b,
                              .streamlines = end - first,
                              .fraction = (double)(end - first) / (double)whole,
                              .length = length / (double)(end - first)};
        first = end;
    }
    return out;
}

/* Sorts what was gathered, and makes connections of it. */
static conus_status count_all(struct rows *out, struct connecting *connecting)
{
    sort_by(connecting, offsetof(struct ended, b));
    sort_by(connecting, offsetof(struct ended, a));
    sort_by(connecting, offsetof(struct ended, bundle));
    const struct ended *all = connecting->all;
    *out = (struct rows){0};
    for (size_t i = 0; i < connecting->count; i++) {
        out->count += i == 0 || !are_alike(&all[i], &all[i - 1]);
    }
    out->at = memory_raw(out->count, sizeof *out->at);
    if (!out->at) {
        return CONUS_ERROR_MEMORY;
    }
    struct row *next = out->at;
    for (size_t first = 0; first < connecting->count;) {
        size_t end = first;
        while (end < connecting->count && all[end].bundle == all[first].bundle) {
            end++;
        }
        next = add_kinds(next, connecting, all + first, end - first);
        first = end;
    }
    order_sort(out->at, out->count, sizeof *out->at, by_count);
    return CONUS_OK;
}

/* Keeps each streamline once, as one of no bundle. */
static void merge_bundles(struct connecting *connecting)
{
    size_t kept = 0;
    sort_by(connecting, offsetof(struct ended, streamline));
    sort_by(connecting, offsetof(struct ended, tractogram));
    for (size_t i = 0; i < connecting->count; i++) {
        struct ended ended = connecting->all[i];
        const struct ended *last = kept ? &connecting->all[kept - 1] : NULL;
        ended.bundle = 0;
        if (!last || last->streamline != ended.streamline || last->tractogram != ended.tractogram) {
            connecting->all[kept++] = ended;
        }
    }
    connecting->count = kept;
}

static struct cell end_name(const struct table_source *source, uint32_t area)
{
    return text_cell(area ? conus_atlas_object(source->atlas, area)->name : "unassigned");
}

static struct cell end_index(const struct table_source *source, uint32_t area)
{
    return area ? integer_cell(conus_atlas_object(source->atlas, area)->label) : no_cell();
}

static struct cell end_a(const struct table_source *source, const void *row, size_t index)
{
    (void)index;
    return end_name(source, ((const struct row *)row)->a);
}

static struct cell end_b(const struct table_source *source, const void *row, size_t index)
{
    (void)index;
    return end_name(source, ((const struct row *)row)->b);
}

static struct cell end_a_index(const struct table_source *source, const void *row, size_t index)
{
    (void)index;
    return end_index(source, ((const struct row *)row)->a);
}

static struct cell end_b_index(const struct table_source *source, const void *row, size_t index)
{
    (void)index;
    return end_index(source, ((const struct row *)row)->b);
}

static const struct table_field columns[] = {
    {"kind", NULL, "bundle; error: no answer, and bundle says why", TABLE_NAME_BY(table_kind)},
    {"bundle", NULL, "name of the bundle", TABLE_NAME_BY(table_object_name)},
    {"end_a", NULL, "name of the area at one end of the streamlines, or unassigned", TABLE_NAME_BY(end_a)},
    {"end_b", NULL, "the same of the other end, which is later in the atlas, or the same area", TABLE_NAME_BY(end_b)},
    {"streamlines", NULL, "how many streamlines of the bundle have these ends",
     TABLE_OF(LARGE_COUNT, struct row, streamlines)},
    {"fraction", NULL, "they as a part of the bundle's streamlines that are in the cone, or of all if there is none",
     TABLE_OF(NUMBER, struct row, fraction)},
    {"mean_length_mm", "mm", "their mean length from end to end", TABLE_OF(NUMBER, struct row, length)},
    {"bundle_index", NULL, "ordinal of the bundle", TABLE_LABEL_BY(table_index)},
    {"end_a_index", NULL, "the atlas's own label of end_a", TABLE_LABEL_BY(end_a_index)},
    {"end_b_index", NULL, "the same of end_b", TABLE_LABEL_BY(end_b_index)},
};

static const struct table_field pair_columns[] = {
    {"end_a", NULL, "name of the area at one end of the streamlines, or unassigned", TABLE_NAME_BY(end_a)},
    {"end_b", NULL, "the same of the other end, which is later, or the same area", TABLE_NAME_BY(end_b)},
    {"streamlines", NULL, "how many streamlines of all bundles have these ends, each counted once",
     TABLE_OF(LARGE_COUNT, struct row, streamlines)},
    {"fraction", NULL, "they as a part of all streamlines that are in the cone, or of all if there is none",
     TABLE_OF(NUMBER, struct row, fraction)},
    {"mean_length_mm", "mm", "their mean length from end to end", TABLE_OF(NUMBER, struct row, length)},
    {"area_a", NULL, "row of end_a in the part areas, from 0", TABLE_OF(COUNT, struct row, area_a)},
    {"area_b", NULL, "the same of end_b", TABLE_OF(COUNT, struct row, area_b)},
};

static const struct table_field area_columns[] = {
    {"name", NULL, "name of the area, or unassigned", TABLE_NAME_BY(table_object_name)},
    {"index", NULL, "the atlas's own label of the area", TABLE_LABEL_BY(table_index)},
};

const struct table_fields connection_fields = {columns, sizeof columns / sizeof *columns};
static const struct table_fields pair_fields = {pair_columns, sizeof pair_columns / sizeof *pair_columns};
static const struct table_fields area_fields = {area_columns, sizeof area_columns / sizeof *area_columns};

static conus_status make_table(conus_table **out, const struct connecting *connecting,
                               const struct table_fields *fields, const void *rows, size_t size, size_t count)
{
    const conus_selector *selector = connecting->selector;
    return table_create(out, &(struct table_source){selector->atlas, &selector->frame}, fields, connecting->asked, rows,
                        size, count);
}

/* Whether the table has these areas. */
static bool lists_areas(const conus_table *table, const struct table_object *areas, size_t count)
{
    bool is_same = conus_table_rows(table) == count;
    for (size_t i = 0; is_same && i < count; i++) {
        is_same = conus_table_objects(table)[i] == areas[i].number;
    }
    return is_same;
}

/* Lists the areas, whose table all answers of the selector share, and finds the row of each. */
static conus_status place_areas(struct connecting *connecting)
{
    conus_selector *selector = connecting->selector;
    struct table_object *areas = NULL;
    conus_table *table = NULL;
    size_t count = 0;
    conus_status status = connection_areas_list(&areas, &count, selector);
    if (!status && !lists_areas(selector->areas, areas, count)) {
        status = make_table(&table, connecting, &area_fields, areas, sizeof *areas, count);
        conus_table_destroy(status ? NULL : selector->areas);
        selector->areas = status ? selector->areas : table;
    }
    connecting->row_of = status ? NULL : memory_raw(selector->atlas->area_count + 1, sizeof *connecting->row_of);
    for (size_t i = 0; connecting->row_of && i <= selector->atlas->area_count; i++) {
        connecting->row_of[i] = (uint32_t)count - 1; /* that of none */
    }
    for (size_t i = 0; connecting->row_of && i < count; i++) {
        connecting->row_of[areas[i].number] = (uint32_t)i;
    }
    memory_free(areas);
    return status || connecting->row_of ? status : CONUS_ERROR_MEMORY;
}

/* Adds the areas, and the pairs of all bundles together, which are no bundle's; those of a single bundle are its rows.
 */
static conus_status add_pairs(conus_table *table, struct connecting *connecting, struct rows *rows)
{
    conus_table *pairs = NULL;
    conus_status status = place_areas(connecting);
    if (!status) {
        table_add_part(table, "areas", table_hold(connecting->selector->areas));
    }
    if (!status && connecting->bundle_count != 1) {
        merge_bundles(connecting);
        memory_free(rows->at);
        status = count_all(rows, connecting);
    }
    for (size_t i = 0; i < rows->count && !status; i++) {
        struct row *row = &rows->at[i];
        row->object = (struct table_object){.kind = CONUS_KIND_UNASSIGNED};
        row->area_a = connecting->row_of[row->a];
        row->area_b = connecting->row_of[row->b];
    }
    status = status ? status : make_table(&pairs, connecting, &pair_fields, rows->at, sizeof *rows->at, rows->count);
    if (!status) {
        table_add_part(table, "pairs", pairs);
    }
    return status;
}

static conus_status build(conus_table **out, struct connecting *connecting, bool with_pairs)
{
    struct rows rows = {0};
    conus_table *table = NULL;
    conus_status status = gather(connecting);
    status = status ? status : find_ends(connecting, connecting->asked->end_radius);
    status = status ? status : count_all(&rows, connecting);
    status = status ? status : make_table(&table, connecting, &connection_fields, rows.at, sizeof *rows.at, rows.count);
    status = status || !with_pairs ? status : add_pairs(table, connecting, &rows);
    area_search_finish(&connecting->search);
    memory_free(rows.at);
    memory_free(connecting->all);
    memory_free(connecting->sorting);
    memory_free(connecting->row_of);
    if (status) {
        conus_table_destroy(table);
        return status;
    }
    *out = table;
    return CONUS_OK;
}

conus_status conus_connectivity(conus_table **out, conus_selector *selector, const conus_selection *selection,
                                double radius, bool with_pairs)
{
    if (!(radius <= RADIUS_LIMIT)) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm round an end, allowed are up to %g", radius, RADIUS_LIMIT);
    }
    if (selection && selection->atlas != selector->atlas) {
        return fail(CONUS_ERROR_ARGUMENT, "connectivity: the selection has another atlas than the selector");
    }
    struct table_question asked = {.end_radius = radius == 0 ? CONUS_ENDPOINT_RADIUS : fmax(radius, 0),
                                   .is_whole = !selection};
    if (selection) {
        bool is_ball = selection->region.shape == REGION_BALL;
        asked.cone = selection->cone;
        asked.ball = is_ball ? selection->region.radius : 0;
    }
    struct connecting connecting = {
        .selector = selector, .region = selection ? &selection->region : NULL, .asked = &asked};
    return build(out, &connecting, with_pairs);
}
