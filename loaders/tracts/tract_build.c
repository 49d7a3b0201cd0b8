/* SPDX-License-Identifier: BSD-3-Clause */
/* Grows the arrays of a tractogram. */
#include "loaders/tracts/tracts.h"

#include "base/formats/packed.h"
#include "base/memory.h"

#include <string.h>

static void resize(struct tract_build *build, void *array, uint64_t count, size_t size)
{
    void *block;
    memcpy(&block, array, sizeof block); /* a pointer of another type is not read as one of this */
    block = job_step(build->job) ? memory_resize(block, count, size) : NULL;
    if (job_need(build->job, block)) {
        memcpy(array, &block, sizeof block);
    }
}

void tract_build_scalar(struct tract_build *build, struct text name, bool per_point, uint32_t components)
{
    struct tractogram *tractogram = &build->tractogram;
    char *words = job_step(build->job) ? text_to_utf8(name) : NULL;
    if (!job_need(build->job, words)) {
        return;
    }
    resize(build, &tractogram->scalars, tractogram->scalar_count + 1, sizeof *tractogram->scalars);
    if (!job_ok(build->job)) {
        memory_free(words);
        return;
    }
    tractogram->scalars[tractogram->scalar_count++] = (struct tract_scalar){words, per_point, components, NULL};
}

static uint64_t bytes_each(const struct tractogram *tractogram, bool per_point)
{
    uint64_t bytes = per_point ? 3 * sizeof *tractogram->points : sizeof *tractogram->first;
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        if (tractogram->scalars[i].per_point == per_point) {
            bytes += tractogram->scalars[i].components * sizeof(float);
        }
    }
    return bytes;
}

/* Points or streamlines for which memory is allowed beside the others. */
static uint64_t most_allowed(const struct tract_build *build, bool per_point)
{
    const struct tractogram *tractogram = &build->tractogram;
    uint64_t others = per_point ? build->streamline_capacity + 1 : build->point_capacity;
    uint64_t taken = others * bytes_each(tractogram, !per_point);
    uint64_t most = taken < build->max_memory ? (build->max_memory - taken) / bytes_each(tractogram, per_point) : 0;
    return per_point || !most ? most : most - 1; /* of first there is one more */
}

static void resize_scalars(struct tract_build *build, bool per_point, uint64_t count)
{
    for (size_t i = 0; i < build->tractogram.scalar_count; i++) {
        struct tract_scalar *scalar = &build->tractogram.scalars[i];
        if (scalar->per_point == per_point) {
            resize(build, &scalar->values, count, scalar->components * sizeof *scalar->values);
        }
    }
}

static void resize_points(struct tract_build *build, uint64_t count)
{
    resize(build, &build->tractogram.points, count, 3 * sizeof *build->tractogram.points);
    resize_scalars(build, true, count);
    build->point_capacity = job_ok(build->job) ? count : build->point_capacity;
}

static void resize_streamlines(struct tract_build *build, uint64_t count)
{
    struct tractogram *tractogram = &build->tractogram;
    bool is_new = !tractogram->first;
    resize(build, &tractogram->first, count + 1, sizeof *tractogram->first);
    if (tractogram->first && is_new) {
        tractogram->first[0] = 0;
    }
    resize_scalars(build, false, count);
    build->streamline_capacity = job_ok(build->job) ? count : build->streamline_capacity;
}

/* Room for `needed`, at least half as much again as there is. */
static bool build_grow(struct tract_build *build, bool per_point, uint64_t needed)
{
    enum { LEAST = 64 };
    uint64_t capacity = per_point ? build->point_capacity : build->streamline_capacity;
    uint64_t most = most_allowed(build, per_point);
    uint64_t wanted = capacity + capacity / 2 + LEAST;
    wanted = smaller_of(wanted < needed ? needed : wanted, most);
    if (needed > most) {
        job_fail(build->job, CONUS_ERROR_MEMORY,
                 "%s: %llu or more take more than the %llu bytes that are allowed (--max-memory)",
                 per_point ? "points" : "streamlines", (unsigned long long)needed,
                 (unsigned long long)build->max_memory);
    }
    (per_point ? resize_points : resize_streamlines)(build, wanted);
    return job_ok(build->job);
}

void tract_build_expect(struct tract_build *build, uint64_t points, uint64_t streamlines)
{
    resize_streamlines(build, smaller_of(streamlines, most_allowed(build, false)));
    resize_points(build, smaller_of(points, most_allowed(build, true)));
}

bool tract_build_points(struct tract_build *build, uint64_t more)
{
    uint64_t needed = build->tractogram.point_count + more;
    bool has_room = needed <= build->point_capacity && build->tractogram.points;
    return has_room ? job_ok(build->job) : build_grow(build, true, needed);
}

bool tract_build_streamline(struct tract_build *build)
{
    uint64_t needed = build->tractogram.streamline_count + 1;
    bool has_room = needed <= build->streamline_capacity && build->tractogram.first;
    if (needed >= UINT32_MAX) {
        job_bad(build->job, "streamlines: found more than %u, which are allowed", UINT32_MAX - 1);
        return false;
    }
    return has_room ? job_ok(build->job) : build_grow(build, false, needed);
}

void tract_build_end(struct tract_build *build)
{
    resize_streamlines(build, build->tractogram.streamline_count);
    resize_points(build, build->tractogram.point_count);
}
