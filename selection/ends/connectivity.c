/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts streamlines by the areas at their ends (Eq. 20). */
#include "selection/ends/connectivity.h"

#include "atlas/bundles.h"
#include "base/memory.h"
#include "base/options.h"
#include "selection/ends/area_at.h"
#include "selection/measure/tract_census.h"
#include "selection/selection.h"
#include "selection/selector.h"

#include <math.h>
#include <stdlib.h>

static const double RADIUS_LIMIT = 100;

/* A streamline as one of a bundle's. */
struct ended {
    uint32_t bundle;
    uint32_t a, b; /* areas as they are reported, less 1: so those without one come last */
    uint32_t streamline;
    size_t tractogram;
    double length;
};

struct connecting {
    conus_selector *selector;
    const struct region *region; /* NULL = everywhere */
    struct area_search search;
    struct ended *all;
    size_t count, capacity;
};

static uint32_t area_of_point(const struct connecting *connecting, const struct tractogram *tractogram, uint64_t index)
{
    const uint32_t *group = level_group(connecting->selector->level);
    double point[3];
    tractogram_point(point, tractogram, index);
    return group[area_at(&connecting->search, point)] - 1;
}

static struct ended end_streamline(const struct connecting *connecting, const struct tractogram *tractogram, uint32_t k)
{
    struct ended ended = {
        .streamline = k, .a = UINT32_MAX, .b = UINT32_MAX, .length = tractogram_length(tractogram, k)};
    uint64_t first = tractogram->first[k];
    uint64_t end = tractogram->first[k + 1];
    if (end > first) {
        uint32_t from = area_of_point(connecting, tractogram, first);
        uint32_t to = end - first > 1 ? area_of_point(connecting, tractogram, end - 1) : from;
        ended.a = from < to ? from : to;
        ended.b = from < to ? to : from;
    }
    return ended;
}

/* Streamlines of a bundle. */
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
    const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, bundle);
    if (!memory_reserve(&connecting->all, &connecting->capacity, connecting->count + members->count,
                        sizeof *connecting->all)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < members->count; i++) {
        struct ended *ended = &connecting->all[connecting->count++];
        *ended = end_streamline(connecting, tractogram, members->numbers ? members->numbers[i] : (uint32_t)i);
        ended->bundle = bundle;
        ended->tractogram = (size_t)(tractogram - atlas->tractograms);
    }
    return CONUS_OK;
}

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

#define ORDER(x, y) (((x) > (y)) - ((x) < (y)))

static int by_ends(const void *a, const void *b)
{
    const struct ended *x = a;
    const struct ended *y = b;
    int order = ORDER(x->bundle, y->bundle);
    order = order ? order : ORDER(x->a, y->a);
    order = order ? order : ORDER(x->b, y->b);
    order = order ? order : ORDER(x->tractogram, y->tractogram);
    return order ? order : ORDER(x->streamline, y->streamline);
}

static int by_streamline(const void *a, const void *b)
{
    const struct ended *x = a;
    const struct ended *y = b;
    int order = ORDER(x->tractogram, y->tractogram);
    return order ? order : ORDER(x->streamline, y->streamline);
}

/* The most streamlines first; areas less 1, as in struct ended. */
static int by_count(const void *a, const void *b)
{
    const conus_connection *x = a;
    const conus_connection *y = b;
    int order = ORDER(x->bundle, y->bundle);
    order = order ? order : ORDER(y->streamlines, x->streamlines);
    order = order ? order : ORDER(x->area_a - 1, y->area_a - 1);
    return order ? order : ORDER(x->area_b - 1, y->area_b - 1);
}

/* Where there is none, there is no array. */
static void sort_all(struct connecting *connecting, int (*order)(const void *a, const void *b))
{
    if (connecting->count) {
        qsort(connecting->all, connecting->count, sizeof *connecting->all, order);
    }
}

/* Whether two sorted streamlines connect the same areas. */
static bool are_alike(const struct ended *a, const struct ended *b)
{
    return a->bundle == b->bundle && a->a == b->a && a->b == b->b;
}

/* Adds the connections of one bundle, which has `whole` streamlines. Returns the end of the rows. */
static conus_connection *add_kinds(conus_connection *out, const struct ended *all, size_t whole)
{
    for (size_t first = 0; first < whole;) {
        size_t end = first;
        double length = 0;
        for (; end < whole && are_alike(&all[end], &all[first]); end++) {
            length += all[end].length;
        }
        *out++ = (conus_connection){.bundle = all[first].bundle,
                                    .area_a = all[first].a + 1,
                                    .area_b = all[first].b + 1,
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
    struct ended *all = connecting->all;
    sort_all(connecting, by_ends);
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
        next = add_kinds(next, all + first, end - first);
        first = end;
    }
    qsort(*out, *count, sizeof **out, by_count);
    return CONUS_OK;
}

static conus_status build(conus_connectivity *connectivity, conus_selector *selector, const struct region *region)
{
    struct connecting connecting = {.selector = selector, .region = region};
    conus_status status = census_prepare(&selector->census, selector->atlas, selector->labels);
    status = status ? status : area_search_init(&connecting.search, selector->atlas, connectivity->radius);
    status = status ? status : gather(&connecting);
    status = status ? status : count_all(&connectivity->rows, &connectivity->row_count, &connecting);
    if (!status) {
        size_t kept = 0;
        sort_all(&connecting, by_streamline); /* each streamline once, of no bundle */
        for (size_t i = 0; i < connecting.count; i++) {
            struct ended ended = connecting.all[i];
            ended.bundle = 0;
            if (!kept || by_streamline(&ended, &connecting.all[kept - 1]) != 0) {
                connecting.all[kept++] = ended;
            }
        }
        connecting.count = kept;
        status = count_all(&connectivity->pairs, &connectivity->pair_count, &connecting);
    }
    area_search_finish(&connecting.search);
    memory_free(connecting.all);
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
        return fail(CONUS_ERROR_ARGUMENT, "connectivity: the selection is of another atlas than the selector");
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
    conus_status status = build(connectivity, selector, selection ? &selection->region : NULL);
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
