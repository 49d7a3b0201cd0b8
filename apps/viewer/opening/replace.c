/* SPDX-License-Identifier: BSD-3-Clause */
/* Matches the objects of an atlas that was opened twice, and copies the user's changes from the first to the second. */
#include "viewer/opening/parts.h"

#include "base/order.h"
#include "conus/own.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How an area was made of those of the file. */
enum part { WHOLE = 0, LEFT_HALF, RIGHT_HALF, PAIR };

/* The properties of an object that stay the same when its atlas is opened in another way. */
struct identity {
    conus_kind kind;
    uint32_t label; /* of the area of the file; 0 = the object is no area */
    enum part part;
    uint32_t number;
    const char *name;
};

/* An atlas's objects, in the order of compare_identities(). */
struct identities {
    const conus_atlas *atlas;
    uint32_t step;            /* as find_step() has it */
    struct identity *ordered; /* [count] */
    size_t count;
};

/* The objects before whose settings an object now takes over. */
struct sources {
    uint32_t numbers[2];
    size_t count;
};

/* One atlas, before and now. */
struct exchange {
    const struct view_atlas *from;
    struct view_atlas *to;
    struct identities before, now;
    const bool *fresh; /* as of struct replacement */
    bool is_other;     /* there are areas now that were not there before */
};

/* The power of ten of the digit 1 to 3 that begins the labels of halves and pairs, the largest ones; 0 = none do. */
static uint32_t find_step(const conus_atlas *atlas, conus_hemispheres how)
{
    uint32_t largest = 0;
    uint32_t step = 1;
    for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        largest = object->kind == CONUS_KIND_AREA && object->label > largest ? object->label : largest;
    }
    while (largest / step > 9) {
        step *= 10;
    }
    return how ? step : 0;
}

static int compare_identities(const void *a, const void *b)
{
    const struct identity *x = a;
    const struct identity *y = b;
    int order = (x->kind > y->kind) - (x->kind < y->kind);
    order = order ? order : (x->label > y->label) - (x->label < y->label);
    order = order ? order : (x->part > y->part) - (x->part < y->part);
    order = order || x->kind == CONUS_KIND_AREA ? order : strcmp(x->name, y->name);
    return order ? order : (x->number > y->number) - (x->number < y->number);
}

static struct identity identity_of(const struct identities *in, uint32_t number)
{
    const conus_object *object = conus_atlas_object(in->atlas, number);
    const bool is_area = object->kind == CONUS_KIND_AREA;
    const bool is_made = in->step && is_area && object->label >= in->step;
    return (struct identity){.kind = object->kind,
                             .label = !is_area  ? 0
                                      : is_made ? object->label % in->step
                                                : object->label,
                             .part = is_made ? (enum part)(object->label / in->step) : WHOLE,
                             .number = number,
                             .name = object->name};
}

/* Its list is the caller's to free; false without memory. */
static bool identities_find(struct identities *out, const conus_atlas *atlas, conus_hemispheres how)
{
    const size_t count = conus_atlas_object_count(atlas);
    *out = (struct identities){atlas, find_step(atlas, how), calloc(count + 1, sizeof *out->ordered), count};
    for (uint32_t number = 1; number <= count && out->ordered; number++) {
        out->ordered[number - 1] = identity_of(out, number);
    }
    if (out->ordered) {
        order_sort(out->ordered, count, sizeof *out->ordered, compare_identities);
    }
    return out->ordered;
}

/* The length of the name without the " left" or " right" of a half. */
static size_t length_of(const struct identity *of)
{
    size_t more = of->part == LEFT_HALF ? strlen(" left") : of->part == RIGHT_HALF ? strlen(" right") : 0;
    size_t length = strlen(of->name);
    return length > more ? length - more : 0;
}

/* Finds the object that is @p part of the area with the label and name of @p of; 0 = none. */
static uint32_t find_part(const struct identities *in, const struct identity *of, enum part part)
{
    const struct identity wanted = {of->kind, of->label, part, 0, of->name};
    size_t low = 0;
    size_t high = in->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (compare_identities(&in->ordered[middle], &wanted) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    for (; low < in->count; low++) {
        const struct identity *found = &in->ordered[low];
        if (found->kind != of->kind || found->label != of->label || found->part != part) {
            return 0;
        }
        if (length_of(found) == length_of(of) && strncmp(found->name, of->name, length_of(of)) == 0) {
            return found->number;
        }
    }
    return 0;
}

/* A pair that was no pair before has no sources: it takes over the settings of its areas. */
static struct sources find_sources(const struct exchange *exchange, uint32_t number)
{
    const struct identity is = identity_of(&exchange->now, number);
    const struct identities *before = &exchange->before;
    uint32_t same = find_part(before, &is, is.part);
    uint32_t whole = is.part == PAIR ? 0 : find_part(before, &is, WHOLE);
    uint32_t left = is.part == WHOLE ? find_part(before, &is, LEFT_HALF) : 0;
    uint32_t right = is.part == WHOLE ? find_part(before, &is, RIGHT_HALF) : 0;
    if (same || whole) {
        return (struct sources){{same ? same : whole}, 1};
    }
    return left && right ? (struct sources){{left, right}, 2} : (struct sources){.count = 0};
}

static bool are_alike(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

static void take_over(struct exchange *exchange, uint32_t number)
{
    const struct view_atlas *from = exchange->from;
    struct view_atlas *to = exchange->to;
    struct sources sources = find_sources(exchange, number);
    const uint32_t *old = sources.numbers;
    if (sources.count) {
        uint32_t last = old[sources.count - 1];
        bool agree = are_alike(from->appearance.opacity[old[0]], from->appearance.opacity[last]);
        to->shown.hidden[number] = from->shown.hidden[old[0]] && from->shown.hidden[last];
        to->appearance.opacity[number] = agree ? from->appearance.opacity[old[0]] : NAN;
        to->appearance.haze[number] = from->appearance.haze[old[0]];
    }
    for (size_t i = 0; i < sources.count; i++) { /* of an area that became two none is chosen */
        bool is_half = identity_of(&exchange->now, number).part > identity_of(&exchange->before, old[i]).part;
        to->shown.chosen = from->shown.chosen == old[i] && !is_half ? number : to->shown.chosen;
    }
}

/* A new pair is hidden where all of its areas are, and has their opacity where they agree. */
static void take_over_pair(struct exchange *exchange, uint32_t pair)
{
    struct view_atlas *to = exchange->to;
    bool all = true;
    uint32_t first = 0;
    bool agree = true;
    for (uint32_t number = 1; number <= to->object_count; number++) {
        if (conus_atlas_object(to->atlas, number)->parent == pair) {
            first = first ? first : number;
            all = all && to->shown.hidden[number];
            agree = agree && are_alike(to->appearance.opacity[number], to->appearance.opacity[first]);
        }
    }
    to->shown.hidden[pair] = first && all;
    to->appearance.opacity[pair] = first && agree ? to->appearance.opacity[first] : NAN;
}

static void take_over_all(struct exchange *exchange)
{
    const struct view_atlas *from = exchange->from;
    struct view_atlas *to = exchange->to;
    if (view_atlas_shares_context(from, to)) {
        memcpy(to->appearance.grey, from->appearance.grey, sizeof to->appearance.grey);
    }
    memcpy(to->shown.search, from->shown.search, sizeof to->shown.search);
    to->appearance.opacity[0] = from->appearance.opacity[0];
    /* A number may have gone with its file, or be another one in the order of them; and its range is of all files. */
    const char *name = tract_colour_name(from->atlas, from->appearance.streamlines);
    size_t colour = name ? tract_colour_find(to->atlas, name) : TRACT_COLOUR_LIMIT;
    if (colour < TRACT_COLOUR_LIMIT) {
        appearance_colour_streamlines(&to->appearance, to->atlas, colour);
    }
    for (uint32_t number = 1; number <= to->object_count; number++) {
        take_over(exchange, number);
    }
    for (uint32_t number = 1; number <= to->object_count; number++) {
        if (identity_of(&exchange->now, number).part == PAIR && !find_sources(exchange, number).count) {
            take_over_pair(exchange, number);
        }
    }
}

static conus_status change_atlas(const struct exchange *exchange)
{
    const struct view_atlas *to = exchange->to;
    conus_status status = CONUS_OK;
    for (uint32_t number = 1; number <= to->object_count && !status; number++) {
        const conus_volume_info *info = view_atlas_pathway(to, number);
        struct sources sources = find_sources(exchange, number);
        const conus_volume_info *was = sources.count ? view_atlas_pathway(exchange->from, sources.numbers[0]) : NULL;
        bool is_asked = exchange->fresh && exchange->fresh[number];
        if (info && was && !is_asked && info->threshold != was->threshold) {
            status = conus_atlas_set_threshold(to->atlas, number, was->threshold);
        }
    }
    return status ? status : conus_atlas_set_hidden(to->atlas, to->shown.hidden);
}

static conus_status exchange_prepare(struct exchange *exchange, const struct replacement *as)
{
    bool fine = identities_find(&exchange->before, exchange->from->atlas, as->before) &&
                identities_find(&exchange->now, exchange->to->atlas, as->how);
    if (!fine) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 1; number <= exchange->now.count; number++) {
        const struct identity is = identity_of(&exchange->now, number);
        bool may_be_new = is.kind != CONUS_KIND_AREA || is.part == PAIR;
        exchange->is_other = exchange->is_other || (!may_be_new && !find_sources(exchange, number).count);
    }
    if (exchange->is_other) {
        return CONUS_ERROR_DATA;
    }
    take_over_all(exchange);
    return change_atlas(exchange);
}

/* Prepares the atlases that replace those of the viewer. */
static conus_status prepare_atlases(struct exchange *all, struct view_atlas *next, const struct viewer *viewer,
                                    const struct replacement *now)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < viewer->atlas_count && !status; i++) {
        const struct view_atlas *from = &viewer->atlases[i];
        const struct view_source source = {now->atlases[i], from->path, from->name};
        status = view_atlas_init(&next[i], &source) ? CONUS_OK : CONUS_ERROR_MEMORY;
        all[i] = (struct exchange){.from = from, .to = &next[i], .fresh = i ? NULL : now->fresh};
        if (!status && viewer->display.safe_colours) {
            conus_atlas_use_safe_colours(now->atlases[i]);
        }
        status = status ? status : exchange_prepare(&all[i], now);
    }
    return status;
}

bool viewer_replace(struct viewer *viewer, const struct replacement *now, char *why, size_t size)
{
    struct exchange *all = calloc(viewer->atlas_count, sizeof *all);
    struct view_atlas *next = calloc(viewer->atlas_count, sizeof *next);
    conus_status status = all && next ? prepare_atlases(all, next, viewer, now) : CONUS_ERROR_MEMORY;
    if (status) {
        bool is_other = false;
        for (size_t i = 0; all && i < viewer->atlas_count; i++) {
            is_other = is_other || all[i].is_other;
        }
        snprintf(why, size, "%s",
                 is_other                       ? "the areas have other names or labels than when the atlas was opened"
                 : status == CONUS_ERROR_MEMORY ? "not enough memory"
                                                : conus_message());
    }
    for (size_t i = 0; i < viewer->pin_count && !status; i++) { /* a result whose area is gone keeps only its name */
        struct pin *pin = &viewer->pins[i];
        if (pin->object) {
            const struct exchange *exchange = &all[pin->atlas];
            const struct identity was = identity_of(&exchange->before, pin->object);
            pin->object = find_part(&exchange->now, &was, was.part);
        }
    }
    if (!status) {
        viewer_exchange(viewer, next);
    }
    for (size_t i = 0; all && next && i < viewer->atlas_count; i++) {
        free(all[i].before.ordered);
        free(all[i].now.ordered);
        view_atlas_finish(&next[i]);
    }
    free(all);
    free(next);
    return !status;
}
