/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the voxels of each object whose centre is in a region. */
#include "selection/measure/census.h"

#include "base/math3.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Distance from a border, as a part of the numbers' size, from which on region_clip() and region_has() agree. */
static const double DOUBT = 4e-7;

/* One volume's rows against one region. */
struct walk {
    const struct region *region;
    const struct volume *volume;
    census_row row;
    void *user;
    const struct census_box *box;
    double margin;           /* mm */
    struct region_line line; /* the row under way */
};

/* Asks for each of the voxels at[0] to `last` of a row. */
static void ask(const struct walk *walk, size_t at[3], size_t last)
{
    for (; at[0] <= last; at[0]++) {
        double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
        mat4_point(p, walk->volume->info.world_from_voxel, p);
        if (region_has(walk->region, p)) {
            walk->row(walk->user, walk->volume, at, 1);
        }
    }
}

/* First and last whole number in an interval of numbers from 0 on; false where there are none. */
static bool whole(size_t out[2], const double interval[2])
{
    int64_t low = (int64_t)interval[0];
    int64_t high = (int64_t)interval[1];
    low += (double)low < interval[0];
    out[0] = (size_t)low;
    out[1] = (size_t)high;
    return low <= high;
}

/* Those of the voxels maybe[0] to maybe[1] of a row that are in the region beyond doubt; false where there are none. */
static bool find_sure(size_t sure[2], const struct walk *walk, const size_t maybe[2])
{
    double inner[2] = {(double)maybe[0], (double)maybe[1]};
    if (region_line_has(walk->region, &walk->line, inner[0], -walk->margin) &&
        region_line_has(walk->region, &walk->line, inner[1], -walk->margin)) {
        memcpy(sure, maybe, 2 * sizeof *sure); /* and all between them, since regions are convex */
        return true;
    }
    return region_clip(inner, walk->region, &walk->line, -walk->margin) && whole(sure, inner);
}

static void walk_row(struct walk *walk, size_t j, size_t k)
{
    double outer[2] = {(double)walk->box->first[0], (double)walk->box->last[0]};
    double p[3] = {0, (double)j, (double)k};
    size_t maybe[2];
    size_t sure[2];
    mat4_point(p, walk->volume->info.world_from_voxel, p);
    region_line_place(&walk->line, walk->region, p);
    if (!region_clip(outer, walk->region, &walk->line, walk->margin) || !whole(maybe, outer)) {
        return;
    }
    size_t at[3] = {maybe[0], j, k};
    if (find_sure(sure, walk, maybe)) {
        if (sure[0] > 0) {
            ask(walk, at, sure[0] - 1);
        }
        walk->row(walk->user, walk->volume, at, sure[1] - sure[0] + 1);
        at[0] = sure[1] + 1;
    }
    ask(walk, at, maybe[1]);
}

/* Of every coordinate on the way. */
static double size_of_numbers(const struct region *region, const struct volume *volume)
{
    double size = vec3_length(region->origin);
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = corner >> a & 1 ? (double)(volume->info.dim[a] - 1) : 0;
        }
        mat4_point(p, volume->info.world_from_voxel, p);
        size = fmax(size, vec3_length(p));
    }
    return 2 * size;
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

void census_walk_box(const struct region *region, const struct volume *volume, const struct census_box *box,
                     census_row row, void *user)
{
    struct walk walk = {.region = region, .volume = volume, .row = row, .user = user, .box = box};
    struct region_bounds bounds;
    size_t slices[2];
    walk.margin = DOUBT * size_of_numbers(region, volume);
    region_line_direct(&walk.line, region, volume->info.world_from_voxel);
    region_bounds_init(&bounds, region, volume);
    if (bounds.depth[0] > bounds.depth[1] || box->last[0] < box->first[0] ||
        !region_bounds_range(slices, &bounds, 2, bounds.depth, volume->info.dim[2])) {
        return;
    }
    for (size_t k = larger(slices[0], box->first[2]); k <= smaller(slices[1], box->last[2]); k++) {
        double depth[2] = {bounds.depth[0], bounds.depth[1]};
        size_t rows[2];
        if (!region_bounds_plane(depth, &bounds, 2, (double)k) ||
            !region_bounds_range(rows, &bounds, 1, depth, volume->info.dim[1])) {
            continue;
        }
        for (size_t j = larger(rows[0], box->first[1]); j <= smaller(rows[1], box->last[1]); j++) {
            walk_row(&walk, j, k);
        }
    }
}

void census_walk(const struct region *region, const struct volume *volume, census_row row, void *user)
{
    const size_t *dim = volume->info.dim;
    const struct census_box all = {.last = {dim[0] - 1, dim[1] - 1, dim[2] - 1}};
    census_walk_box(region, volume, &all, row, user);
}

static void include(struct census_box *box, const size_t at[3])
{
    for (int a = 0; a < 3; a++) {
        box->first[a] = smaller(box->first[a], at[a]);
        box->last[a] = larger(box->last[a], at[a]);
    }
}

static struct census_box find_box(const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    struct census_box box = {.first = {SIZE_MAX, SIZE_MAX, SIZE_MAX}};
    for (size_t row = 0; row < dim[1] * dim[2]; row++) {
        size_t first = 0;
        size_t last = dim[0];
        while (first < dim[0] && !volume_object(volume, row * dim[0] + first)) {
            first++;
        }
        while (last > first && !volume_object(volume, row * dim[0] + last - 1)) {
            last--;
        }
        if (first < last) {
            include(&box, (const size_t[]){first, row % dim[1], row / dim[1]});
            include(&box, (const size_t[]){last - 1, row % dim[1], row / dim[1]});
        }
    }
    return box;
}

conus_status census_prepare(struct census *census, const conus_atlas *atlas)
{
    if (census->counts && census->object_count >= atlas->object_count) {
        return CONUS_OK;
    }
    struct census fresh = {.object_count = atlas->object_count};
    fresh.counts = memory_zeroed(atlas->object_count + 1, sizeof *fresh.counts);
    fresh.touched = memory_raw(atlas->object_count + 1, sizeof *fresh.touched);
    fresh.boxes = memory_zeroed(atlas->volume_count, sizeof *fresh.boxes);
    if (!fresh.counts || !fresh.touched || !fresh.boxes) {
        census_finish(&fresh);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (volume_is_scalar(&atlas->volumes[i]) && volume_can_be_hit(&atlas->volumes[i])) {
            fresh.boxes[i] = find_box(&atlas->volumes[i]);
        }
    }
    census_finish(census);
    *census = fresh;
    return CONUS_OK;
}

void census_finish(struct census *census)
{
    memory_free(census->counts);
    memory_free(census->touched);
    memory_free(census->boxes);
    *census = (struct census){0};
}

/* `count` voxels of one object in a row. */
static void add_run(struct census *census, uint32_t object, const size_t at[3], size_t count)
{
    struct census_count *sum = &census->counts[object];
    if (!sum->voxels && object) {
        census->touched[census->touched_count++] = object;
    }
    sum->voxels += count;
    sum->index[0] += count * at[0] + count * (count - 1) / 2;
    sum->index[1] += count * at[1];
    sum->index[2] += count * at[2];
}

static void add_areas(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct census *census = user;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    for (size_t done = 0; done < count;) {
        uint32_t object = volume_object(volume, first + done);
        size_t end = done + 1;
        while (end < count && volume_object(volume, first + end) == object) {
            end++;
        }
        const size_t start[3] = {at[0] + done, at[1], at[2]};
        add_run(census, object, start, end - done);
        done = end;
    }
}

static void add_value(struct census_count *sum, double value, const size_t at[3])
{
    sum->maximum = sum->voxels > 1 ? fmax(sum->maximum, value) : value;
    sum->value += value;
    for (int a = 0; a < 3; a++) {
        sum->moment[a] += value * (double)at[a];
    }
}

static void add_values(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct census *census = user;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    for (size_t i = 0; i < count; i++) {
        uint32_t object = volume_object(volume, first + i);
        if (object) {
            const size_t voxel[3] = {at[0] + i, at[1], at[2]};
            add_run(census, object, voxel, 1);
            add_value(&census->counts[object], (double)volume->values[first + i], voxel);
        }
    }
}

static int ascending(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a;
    uint32_t y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static void forget(struct census *census)
{
    for (size_t i = 0; i < census->touched_count; i++) {
        census->counts[census->touched[i]] = (struct census_count){0};
    }
    census->counts[0] = (struct census_count){0};
    census->touched_count = 0;
}

void census_take(struct census *census, const conus_atlas *atlas, const struct region *region)
{
    forget(census);
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (volume->info.role == CONUS_ROLE_PARCELLATION) {
            census_walk(region, volume, add_areas, census);
        } else if (volume_is_scalar(volume) && volume_can_be_hit(volume)) {
            census_walk_box(region, volume, &census->boxes[i], add_values, census);
        }
    }
    qsort(census->touched, census->touched_count, sizeof *census->touched, ascending);
}

bool census_is_weighted(const conus_atlas *atlas, uint32_t object)
{
    return atlas_object_volume(atlas, object)->values && !atlas->objects[object - 1].is_band;
}

void census_centroid(double out[3], const struct census *census, const conus_atlas *atlas, uint32_t object)
{
    const struct census_count *count = &census->counts[object];
    const struct volume *volume = atlas_object_volume(atlas, object);
    bool weighted = census_is_weighted(atlas, object);
    double index[3];
    for (int a = 0; a < 3; a++) {
        index[a] = weighted ? count->moment[a] / count->value : (double)count->index[a] / (double)count->voxels;
    }
    mat4_point(out, volume->info.world_from_voxel, index);
}
