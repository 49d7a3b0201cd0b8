/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts streamlines by the areas at their ends (Eq. 20). */
#include "selection/ends/connectivity.h"

#include "atlas/bundles.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/order.h"
#include "base/threads.h"
#include "selection/ends/area_at.h"
#include "selection/measure/tract_census.h"
#include "selection/selection.h"
#include "selection/selector.h"

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

struct connecting {
    const conus_selector *selector;
    const struct region *region; /* NULL = everywhere */
    struct area_search search;
    struct ended *all;
    size_t count, capacity;
    struct ended *sorting; /* [count] */
    size_t bundle_count;   /* of those that have streamlines here */
    size_t pieces;         /* for threads */
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
    const conus_connection *x = a;
    const conus_connection *y = b;
    int order = compare_unsigned(x->bundle, y->bundle);
    order = order ? order : compare_unsigned(y->streamlines, x->streamlines);
    order = order ? order : compare_unsigned(x->area_a - 1, y->area_a - 1);
    return order ? order : compare_unsigned(x->area_b - 1, y->area_b - 1);
}

/* Whether two sorted streamlines connect the same areas. */
static bool are_alike(const struct ended *a, const struct ended *b)
{
    return a->bundle == b->bundle && a->a == b->a && a->b == b->b;
}

/* Adds the connections of one bundle, which has `whole` streamlines. Returns the end of the rows. */
static conus_connection *add_kinds(conus_connection *out, const conus_atlas *atlas, const struct ended *all,
                                   size_t whole)
{
    for (size_t first = 0; first < whole;) {
        size_t end = first;
        double length = 0;
        for (; end < whole && are_alike(&all[end], &all[first]); end++) {
            length += tractogram_length(&atlas->tractograms[all[end].tractogram], all[end].streamline);
        }
        *out++ = (conus_connection){.bundle = all[first].bundle,
                                    .area_a = all[first].a < atlas->area_count ? all[first].a + 1 : 0,
                                    .area_b = all[first].b < atlas->area_count ? all[first].b + 1 : 0,
                                    .streamlines = end - first,
                                    .fraction = (double)(end - first) / (double)whole,
                                    .length = length / (double)(end - first)};
        first = end;
    }
    return out;
}

/* Sorts what was gathered, and makes connections of it. */
static conus_status count_all(conus_connection **out, size_t *count, struct connecting *connecting)
{
    sort_by(connecting, offsetof(struct ended, b));
    sort_by(connecting, offsetof(struct ended, a));
    sort_by(connecting, offsetof(struct ended, bundle));
    const struct ended *all = connecting->all;
    *count = 0;
    for (size_t i = 0; i < connecting->count; i++) {
        *count += i == 0 || !are_alike(&all[i], &all[i - 1]);
    }
    *out = memory_raw(*count, sizeof **out);
    if (!*out) {
        return CONUS_ERROR_MEMORY;
    }
    conus_connection *next = *out;
    for (size_t first = 0; first < connecting->count;) {
        size_t end = first;
        while (end < connecting->count && all[end].bundle == all[first].bundle) {
            end++;
        }
        next = add_kinds(next, connecting->selector->atlas, all + first, end - first);
        first = end;
    }
    order_sort(*out, *count, sizeof **out, by_count);
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

/* A single bundle's pairs are its rows. */
static conus_status copy_rows(conus_connectivity *connectivity)
{
    connectivity->pairs = memory_copy(connectivity->rows, connectivity->row_count, sizeof *connectivity->rows);
    if (!connectivity->pairs) {
        return CONUS_ERROR_MEMORY;
    }
    connectivity->pair_count = connectivity->row_count;
    for (size_t i = 0; i < connectivity->pair_count; i++) {
        connectivity->pairs[i].bundle = 0;
    }
    return CONUS_OK;
}

static conus_status build(conus_connectivity *connectivity, const conus_selector *selector, const struct region *region)
{
    struct connecting connecting = {.selector = selector, .region = region};
    conus_status status = gather(&connecting);
    status = status ? status : find_ends(&connecting, connectivity->radius);
    status = status ? status : count_all(&connectivity->rows, &connectivity->row_count, &connecting);
    if (!status && connecting.bundle_count == 1) {
        status = copy_rows(connectivity);
    } else if (!status) {
        merge_bundles(&connecting);
        status = count_all(&connectivity->pairs, &connectivity->pair_count, &connecting);
    }
    area_search_finish(&connecting.search);
    memory_free(connecting.all);
    memory_free(connecting.sorting);
    return status;
}

conus_status conus_connectivity_create(conus_connectivity **out, conus_selector *selector,
                                       const conus_selection *selection, const conus_connectivity_options *options)
{
    double radius = options_of(conus_connectivity_options, options)->radius;
    if (!(radius <= RADIUS_LIMIT)) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm round an end, allowed are up to %g", radius, RADIUS_LIMIT);
    }
    if (selection && selection->atlas != selector->atlas) {
        return fail(CONUS_ERROR_ARGUMENT, "connectivity: the selection has another atlas than the selector");
    }
    conus_connectivity *connectivity = memory_zeroed(1, sizeof *connectivity);
    if (!connectivity) {
        return CONUS_ERROR_MEMORY;
    }
    connectivity->radius = radius == 0 ? CONUS_ENDPOINT_RADIUS : fmax(radius, 0);
    connectivity->is_whole = !selection;
    if (selection) {
        bool is_ball = selection->region.shape == REGION_BALL;
        connectivity->cone = selection->cone;
        connectivity->ball = is_ball ? selection->region.radius : 0;
    }
    conus_status status = connection_areas_list(connectivity, selector);
    status = status ? status : build(connectivity, selector, selection ? &selection->region : NULL);
    if (status) {
        conus_connectivity_destroy(connectivity);
        return status;
    }
    *out = connectivity;
    return CONUS_OK;
}

void conus_connectivity_destroy(conus_connectivity *connectivity)
{
    if (connectivity) {
        memory_free(connectivity->rows);
        memory_free(connectivity->pairs);
        memory_free(connectivity->areas);
        memory_free(connectivity->streamlines);
        memory_free(connectivity->length);
        memory_free(connectivity);
    }
}

size_t conus_connectivity_count(const conus_connectivity *connectivity)
{
    return connectivity ? connectivity->row_count : 0;
}

const conus_connection *conus_connectivity_connection(const conus_connectivity *connectivity, size_t index)
{
    return connectivity && index < connectivity->row_count ? &connectivity->rows[index] : NULL;
}

size_t conus_connectivity_pair_count(const conus_connectivity *connectivity)
{
    return connectivity ? connectivity->pair_count : 0;
}

const conus_connection *conus_connectivity_pair(const conus_connectivity *connectivity, size_t index)
{
    return connectivity && index < connectivity->pair_count ? &connectivity->pairs[index] : NULL;
}
