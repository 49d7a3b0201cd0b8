/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects, sorts, clips and regroups the intervals of all rays. */
#include "selection/evidence/evidence.h"

#include "base/memory.h"
#include "base/order.h"

#include <stdlib.h>

enum { FIRST_CAPACITY = 1024, FEW = 64 };

void layers_finish(struct layers *layers)
{
    memory_free(layers->intervals);
    *layers = (struct layers){0};
}

conus_status layers_reserve(struct layers *layers, size_t more)
{
    while (layers->capacity - layers->count < more) {
        size_t capacity = layers->capacity ? 2 * layers->capacity : FIRST_CAPACITY;
        conus_interval *intervals = memory_resize(layers->intervals, capacity, sizeof *intervals);
        if (!intervals) {
            return CONUS_ERROR_MEMORY;
        }
        layers->intervals = intervals;
        layers->capacity = capacity;
    }
    return CONUS_OK;
}

conus_status layers_add(struct layers *layers, const conus_interval *interval)
{
    conus_status status = layers_reserve(layers, 1);
    if (!status) {
        layers->intervals[layers->count++] = *interval;
    }
    return status;
}

static bool is_before(const conus_interval *a, const conus_interval *b)
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

/* Sorts few intervals by insertion, since most of them are in order. */
static void sort_pixel(conus_interval *intervals, size_t count)
{
    if (count > FEW) {
        order_sort(intervals, count, sizeof *intervals, compare);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        conus_interval interval = intervals[i];
        size_t place = i;
        for (; place > 0 && is_before(&interval, &intervals[place - 1]); place--) {
            intervals[place] = intervals[place - 1];
        }
        intervals[place] = interval;
    }
}

conus_status layers_sort(struct layers *layers, size_t pixels)
{
    if (pixels == 1) {
        sort_pixel(layers->intervals, layers->count);
        return CONUS_OK;
    }
    conus_interval *sorted = memory_raw(layers->capacity, sizeof *sorted);
    size_t *end = memory_zeroed(pixels, sizeof *end);
    if (!sorted || !end) {
        memory_free(sorted);
        memory_free(end);
        return CONUS_ERROR_MEMORY;
    }
    /* Move the intervals to `sorted`, pixel by pixel; end[p] becomes one past the last of pixel p. */
    size_t total = 0;
    for (size_t i = 0; i < layers->count; i++) {
        end[layers->intervals[i].pixel]++;
    }
    for (size_t p = 0; p < pixels; p++) {
        size_t first = total;
        total += end[p];
        end[p] = first;
    }
    for (size_t i = 0; i < layers->count; i++) {
        sorted[end[layers->intervals[i].pixel]++] = layers->intervals[i];
    }
    for (size_t p = 0, first = 0; p < pixels; first = end[p++]) {
        sort_pixel(sorted + first, end[p] - first);
    }
    memory_free(layers->intervals);
    memory_free(end);
    layers->intervals = sorted;
    return CONUS_OK;
}

void layers_clip(struct layers *layers, const struct cone *cone)
{
    size_t kept = 0;
    size_t first = 0; /* of the pixel's kept intervals */
    for (size_t i = 0; i < layers->count; i++) {
        conus_interval interval = layers->intervals[i];
        double per_depth = cone_per_depth(cone, interval.pixel % cone->resolution, interval.pixel / cone->resolution);
        double near = cone->range[0] * per_depth;
        double far = cone->range[1] * per_depth;
        if (i == 0 || layers->intervals[i - 1].pixel != interval.pixel) {
            sort_pixel(layers->intervals + first, kept - first);
            first = kept;
        }
        if (interval.entry <= far && interval.exit >= near) {
            interval.entry = interval.entry < near ? near : interval.entry;
            interval.exit = interval.exit > far ? far : interval.exit;
            layers->intervals[kept++] = interval;
        }
    }
    sort_pixel(layers->intervals + first, kept - first);
    layers->count = kept;
}

bool layers_first(struct evidence *out, const struct layers *layers)
{
    bool is_certain = true;
    const conus_interval *first = NULL; /* of the pixel */
    evidence_clear(out);
    for (size_t i = 0; i < layers->count; i++) {
        const conus_interval *interval = &layers->intervals[i];
        if (!first || first->pixel != interval->pixel) {
            first = interval;
            out->object[interval->pixel] = interval->object;
            out->distance[interval->pixel] = interval->entry;
            out->voxel[interval->pixel] = interval->voxel;
        } else if (interval->entry == first->entry) {
            is_certain = false;
        }
    }
    return is_certain;
}

/* Takes intervals first to end of one pixel to @p kept on; last[] is where the last interval of each object went, + 1.
 * Returns one past the last. */
static size_t regroup_pixel(conus_interval *intervals, size_t first, size_t end, size_t kept, const uint32_t *group,
                            size_t *last)
{
    size_t start = kept;
    for (size_t i = first; i < end; i++) {
        conus_interval interval = intervals[i];
        interval.object = group[interval.object];
        conus_interval *before = last[interval.object] > start ? &intervals[last[interval.object] - 1] : NULL;
        if (before && interval.entry <= before->exit) {
            before->exit = interval.exit > before->exit ? interval.exit : before->exit;
        } else {
            intervals[kept++] = interval;
            last[interval.object] = kept;
        }
    }
    sort_pixel(intervals + start, kept - start);
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
        while (end < layers->count && layers->intervals[end].pixel == layers->intervals[first].pixel) {
            end++;
        }
        kept = regroup_pixel(layers->intervals, first, end, kept, group, last);
    }
    layers->count = kept;
    memory_free(last);
    return CONUS_OK;
}

void layers_drop_blockers(struct layers *layers)
{
    size_t kept = 0;
    while (kept < layers->count && layers->intervals[kept].object != VOLUME_BLOCKER) {
        kept++; /* mostly all stay, where they are */
    }
    for (size_t i = kept; i < layers->count; i++) {
        if (layers->intervals[i].object != VOLUME_BLOCKER) {
            layers->intervals[kept++] = layers->intervals[i];
        }
    }
    layers->count = kept;
}
