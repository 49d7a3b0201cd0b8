/* SPDX-License-Identifier: BSD-3-Clause */
/* The clearance of needles of 60 mm through the middle of an atlas from its areas: by every cell, one by one, against
 * the search, for all areas and for one. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"
#include "selection/measure/measure.h"

static const double LENGTH = 60; /* mm */
static const double LIMIT = 10;  /* mm */
static const double MIDDLE = 20; /* mm: so far from the middle of the atlas that of a needle may be, along each axis */
static const double FARTHEST = 1e6;

/* Needles and, for each, its distances from all areas. */
struct way {
    const struct volume *volume;
    struct clearance_question question;
    struct clearance clearance;
    struct needle *needles;
    size_t count;
    double *distances; /* [count][object_count + 1] */
};

/* Tries every cell whose centre is near enough. */
static void measure_cells(void *data)
{
    struct way *way = data;
    const struct volume *volume = way->volume;
    const size_t *dim = volume->info.dim;
    const double *m = volume->info.world_from_voxel;
    double reach = LIMIT + (vec3_length(m) + vec3_length(m + 4) + vec3_length(m + 8)) / 2;
    for (size_t n = 0; n < way->count; n++) {
        const struct needle *needle = &way->needles[n];
        double *distances = way->distances + n * (way->question.atlas->object_count + 1);
        struct needle_frame frame;
        needle_frame_init(&frame, needle, volume->voxel_from_world);
        for (size_t v = 0; v < volume->voxel_count; v++) {
            uint32_t object = volume_object(volume, v);
            if (object) {
                const size_t at[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
                double low[3] = {(double)at[0], (double)at[1], (double)at[2]};
                double high[3];
                double foot[3];
                double depth;
                mat4_point(foot, m, low);
                vec3_sub(foot, foot, needle->origin);
                vec3_add_scaled(foot, foot, -fmin(fmax(vec3_dot(foot, needle->direction), needle->near), needle->far),
                                needle->direction);
                if (vec3_dot(foot, foot) <= reach * reach) {
                    for (int a = 0; a < 3; a++) {
                        high[a] = low[a] + 0.5;
                        low[a] -= 0.5;
                    }
                    double distance = needle_box(&depth, &frame, low, high);
                    distances[object] =
                        distance < distances[object] && distance <= LIMIT ? distance : distances[object];
                }
            }
        }
    }
}

static void search(void *data)
{
    struct way *way = data;
    for (size_t n = 0; n < way->count; n++) {
        double *distances = way->distances + n * (way->question.atlas->object_count + 1);
        clearance_take(&way->clearance, &way->question, &way->needles[n]);
        for (size_t i = 0; i < way->clearance.touched_count; i++) {
            uint32_t object = way->clearance.touched[i];
            distances[object] = way->clearance.found[object].distance;
        }
    }
}

static conus_status make_needles(struct way *way, size_t count)
{
    const struct clearance_index *index = way->question.index;
    uint64_t state = 21;
    way->needles = memory_raw(count, sizeof *way->needles);
    way->count = way->needles ? count : 0;
    for (size_t n = 0; n < way->count; n++) {
        struct needle *needle = &way->needles[n];
        double along[3] = {bench_random(&state, -1, 1), bench_random(&state, -1, 1), bench_random(&state, 0.1, 1)};
        vec3_normalise(needle->direction, along);
        for (int a = 0; a < 3; a++) {
            needle->origin[a] = (index->low[a] + index->high[a]) / 2 + bench_random(&state, -MIDDLE, MIDDLE) -
                                LENGTH / 2 * needle->direction[a];
        }
        needle->near = 0;
        needle->far = LENGTH;
    }
    return way->needles ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status prepare(struct way *way)
{
    size_t size = way->count * (way->question.atlas->object_count + 1);
    way->distances = memory_raw(size, sizeof *way->distances);
    for (size_t i = 0; way->distances && i < size; i++) {
        way->distances[i] = INFINITY;
    }
    return way->distances ? clearance_prepare(&way->clearance, way->question.atlas) : CONUS_ERROR_MEMORY;
}

static bool is_same(const struct way *a, const struct way *b)
{
    bool same = true;
    for (size_t i = 0; i < a->count * (a->question.atlas->object_count + 1); i++) {
        same = same && (a->distances[i] == b->distances[i] || fabs(a->distances[i] - b->distances[i]) <= 1e-9);
    }
    return same;
}

static conus_status measure(struct bench *bench, struct way ways[3])
{
    struct bench_variant variants[3] = {
        {.name = "every cell near the needle", .run = measure_cells, .data = &ways[0], .equal = true},
        {.name = "all areas within 10 mm", .run = search, .data = &ways[1]},
        {.name = "one area, however far", .run = search, .data = &ways[2], .other_by_design = true}};
    measure_cells(&ways[0]);
    search(&ways[1]);
    variants[1].equal = is_same(&ways[0], &ways[1]);
    conus_status status = bench_measure(bench, "clearance", variants, 3, ways[0].count, 0);
    status = status ? status : bench_value(bench, "clearance_needle_ms", variants[1].median_ms, variants[1].equal);
    return status ? status : bench_ratio(bench, "cells_over_clearance", &variants[0], &variants[1]);
}

conus_status bench_clearance(struct bench *bench)
{
    conus_atlas *atlas = NULL;
    struct clearance_index *index = NULL;
    struct way ways[3] = {0};
    bench->one_thread = true;
    conus_status status = bench_load_labels(&atlas, bench->options.atlas);
    status = status ? status : clearance_index_create(&index, atlas);
    size_t objects = status ? 0 : atlas->object_count + 1;
    uint32_t *groups = memory_zeroed(2 * objects, sizeof *groups); /* all as themselves; one */
    status = status || groups ? status : CONUS_ERROR_MEMORY;
    for (uint32_t object = 0; !status && object < objects; object++) {
        groups[object] = object;
        groups[objects + object] = object == objects / 2 ? object : 0;
    }
    for (size_t i = 0; !status && i < 3; i++) {
        ways[i].volume = &atlas->volumes[0];
        ways[i].question = (struct clearance_question){.atlas = atlas,
                                                       .index = index,
                                                       .groups = groups + (i == 2 ? objects : 0),
                                                       .limit = i == 2 ? FARTHEST : LIMIT};
        status = make_needles(&ways[i], bench->options.poses);
        status = status ? status : prepare(&ways[i]);
    }
    status = status ? status : measure(bench, ways);
    for (size_t i = 0; i < 3; i++) {
        clearance_finish(&ways[i].clearance);
        memory_free(ways[i].needles);
        memory_free(ways[i].distances);
    }
    memory_free(groups);
    clearance_index_destroy(index);
    conus_atlas_destroy(atlas);
    return status;
}
