/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects, sorts, clips and regroups the intervals of all rays. */
#include "selection/engine/layers.h"

#include "base/memory.h"

#include <stdlib.h>

enum { FIRST_CAPACITY = 1024, FEW = 64 };

void layers_finish(struct layers *layers)
{
    memory_free(layers->spans);
    *layers = (struct layers){0};
}

static conus_status grow(struct layers *layers)
{
    size_t capacity = layers->capacity ? 2 * layers->capacity : FIRST_CAPACITY;
    conus_span *spans = memory_resize(layers->spans, capacity, sizeof *spans);
    if (!spans) {
        return CONUS_ERROR_MEMORY;
    }
    layers->spans = spans;
    layers->capacity = capacity;
    return CONUS_OK;
}

conus_status layers_add(struct layers *layers, const conus_span *span)
{
    conus_status status = layers->count < layers->capacity ? CONUS_OK : grow(layers);
    if (!status) {
        layers->spans[layers->count++] = *span;
    }
    return status;
}

static bool is_before(const conus_span *a, const conus_span *b)
{
    if (a->entry != b->entry) {
        return a->entry < b->entry;
    }
    return a->object != b->object ? a->object < b->object : a->exit < b->exit;
}

static int compare(const void *a, const void *b)
{
    return is_before(a, b) ? -1 : is_before(b, a);
}

/* By insertion as long as they are few: most of them are in order. */
static void sort_pixel(conus_span *spans, size_t count)
{
    if (count > FEW) {
        qsort(spans, count, sizeof *spans, compare);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        conus_span span = spans[i];
        size_t place = i;
        for (; place > 0 && is_before(&span, &spans[place - 1]); place--) {
            spans[place] = spans[place - 1];
        }
        spans[place] = span;
    }
}

/* Moves the spans to out, pixel by pixel; end[p] becomes one past the last of pixel p. */
static void deal_to_pixels(conus_span *out, size_t *end, const struct layers *layers, size_t pixels)
{
    size_t total = 0;
    for (size_t i = 0; i < layers->count; i++) {
        end[layers->spans[i].pixel]++;
    }
    for (size_t p = 0; p < pixels; p++) {
        size_t first = total;
        total += end[p];
        end[p] = first;
    }
    for (size_t i = 0; i < layers->count; i++) {
        out[end[layers->spans[i].pixel]++] = layers->spans[i];
    }
}

conus_status layers_sort(struct layers *layers, size_t pixels)
{
    conus_span *sorted = memory_raw(layers->capacity, sizeof *sorted);
    size_t *end = memory_zeroed(pixels, sizeof *end);
    if (!sorted || !end) {
        memory_free(sorted);
        memory_free(end);
        return CONUS_ERROR_MEMORY;
    }
    deal_to_pixels(sorted, end, layers, pixels);
    for (size_t p = 0, first = 0; p < pixels; first = end[p++]) {
        sort_pixel(sorted + first, end[p] - first);
    }
    memory_free(layers->spans);
    memory_free(end);
    layers->spans = sorted;
    return CONUS_OK;
}

void layers_clip(struct layers *layers, const struct cone *cone)
{
    size_t kept = 0;
    size_t first = 0; /* of the pixel's kept spans */
    for (size_t i = 0; i < layers->count; i++) {
        conus_span span = layers->spans[i];
        double per_depth = cone_per_depth(cone, span.pixel % cone->resolution, span.pixel / cone->resolution);
        double near = cone->range[0] * per_depth;
        double far = cone->range[1] * per_depth;
        if (i == 0 || layers->spans[i - 1].pixel != span.pixel) {
            sort_pixel(layers->spans + first, kept - first);
            first = kept;
        }
        if (span.entry <= far && span.exit >= near) {
            span.entry = span.entry < near ? near : span.entry;
            span.exit = span.exit > far ? far : span.exit;
            layers->spans[kept++] = span;
        }
    }
    sort_pixel(layers->spans + first, kept - first);
    layers->count = kept;
}

void layers_first(struct evidence *out, const struct layers *layers)
{
    evidence_clear(out);
    for (size_t i = layers->count; i > 0; i--) {
        const conus_span *span = &layers->spans[i - 1];
        out->object[span->pixel] = span->object;
        out->distance[span->pixel] = span->entry;
        out->voxel[span->pixel] = span->voxel;
    }
}

/* Takes spans first to end of one pixel to @p kept on; last[] is where the last span of each object went, + 1. Returns
 * one past the last. */
static size_t regroup_pixel(conus_span *spans, size_t first, size_t end, size_t kept, const uint32_t *group,
                            size_t *last)
{
    size_t start = kept;
    for (size_t i = first; i < end; i++) {
        conus_span span = spans[i];
        span.object = group[span.object];
        conus_span *before = last[span.object] > start ? &spans[last[span.object] - 1] : NULL;
        if (before && span.entry <= before->exit) {
            before->exit = span.exit > before->exit ? span.exit : before->exit;
        } else {
            spans[kept++] = span;
            last[span.object] = kept;
        }
    }
    sort_pixel(spans + start, kept - start);
    return kept;
}

conus_status layers_regroup(struct layers *layers, const uint32_t *group, size_t object_count)
{
    size_t *last = memory_zeroed(object_count + 1, sizeof *last);
    size_t kept = 0;
    if (!last) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t first = 0, end = 0; first < layers->count; first = end) {
        while (end < layers->count && layers->spans[end].pixel == layers->spans[first].pixel) {
            end++;
        }
        kept = regroup_pixel(layers->spans, first, end, kept, group, last);
    }
    layers->count = kept;
    memory_free(last);
    return CONUS_OK;
}

void layers_drop_blockers(struct layers *layers)
{
    size_t kept = 0;
    for (size_t i = 0; i < layers->count; i++) {
        if (layers->spans[i].object != VOLUME_BLOCKER) {
            layers->spans[kept++] = layers->spans[i];
        }
    }
    layers->count = kept;
}
