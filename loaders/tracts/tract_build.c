/* SPDX-License-Identifier: BSD-3-Clause */
/* Grows the arrays of a tractogram. */
#include "loaders/tracts/tract_build.h"

#include "base/formats/gzip.h"
#include "base/memory.h"

void tract_build_finish(struct tract_build *build)
{
    tractogram_finish(&build->tractogram);
    *build = (struct tract_build){0};
}

conus_status tract_build_scalar(struct tract_build *build, struct text name, bool per_point, uint32_t components)
{
    struct tractogram *tractogram = &build->tractogram;
    struct tract_scalar *scalars = memory_resize(tractogram->scalars, tractogram->scalar_count + 1, sizeof *scalars);
    tractogram->scalars = scalars ? scalars : tractogram->scalars;
    char *words = scalars ? text_to_utf8(name) : NULL;
    if (!words) {
        return CONUS_ERROR_MEMORY;
    }
    scalars[tractogram->scalar_count++] = (struct tract_scalar){words, per_point, components, NULL};
    return CONUS_OK;
}

/* Bytes per point or per streamline. */
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

static conus_status resize_scalars(struct tractogram *tractogram, bool per_point, uint64_t count)
{
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        struct tract_scalar *scalar = &tractogram->scalars[i];
        if (scalar->per_point == per_point) {
            float *values = memory_resize(scalar->values, count, scalar->components * sizeof *values);
            if (!values) {
                return CONUS_ERROR_MEMORY;
            }
            scalar->values = values;
        }
    }
    return CONUS_OK;
}

static conus_status resize_points(struct tract_build *build, uint64_t count)
{
    struct tractogram *tractogram = &build->tractogram;
    float *points = memory_resize(tractogram->points, count, 3 * sizeof *points);
    tractogram->points = points ? points : tractogram->points;
    conus_status status = points ? resize_scalars(tractogram, true, count) : CONUS_ERROR_MEMORY;
    build->point_capacity = status ? build->point_capacity : count;
    return status;
}

static conus_status resize_streamlines(struct tract_build *build, uint64_t count)
{
    struct tractogram *tractogram = &build->tractogram;
    bool is_new = !tractogram->first;
    uint64_t *first = memory_resize(tractogram->first, count + 1, sizeof *first);
    tractogram->first = first ? first : tractogram->first;
    if (first && is_new) {
        first[0] = 0;
    }
    conus_status status = first ? resize_scalars(tractogram, false, count) : CONUS_ERROR_MEMORY;
    build->streamline_capacity = status ? build->streamline_capacity : count;
    return status;
}

/* Room for `needed`, at least half as much again as there is. */
static conus_status build_grow(struct tract_build *build, bool per_point, uint64_t needed)
{
    enum { LEAST = 64 };
    uint64_t capacity = per_point ? build->point_capacity : build->streamline_capacity;
    uint64_t most = most_allowed(build, per_point);
    uint64_t wanted = capacity + capacity / 2 + LEAST;
    wanted = smaller_of(wanted < needed ? needed : wanted, most);
    if (needed > most) {
        return fail(
            CONUS_ERROR_MEMORY, "%s: %llu or more take more than the %llu bytes that are allowed (--max-memory)",
            per_point ? "points" : "streamlines", (unsigned long long)needed, (unsigned long long)build->max_memory);
    }
    return per_point ? resize_points(build, wanted) : resize_streamlines(build, wanted);
}

conus_status tract_build_expect(struct tract_build *build, uint64_t points, uint64_t streamlines)
{
    conus_status status = resize_streamlines(build, smaller_of(streamlines, most_allowed(build, false)));
    return status ? status : resize_points(build, smaller_of(points, most_allowed(build, true)));
}

conus_status tract_build_points(struct tract_build *build, uint64_t more)
{
    uint64_t needed = build->tractogram.point_count + more;
    return needed <= build->point_capacity && build->tractogram.points ? CONUS_OK : build_grow(build, true, needed);
}

conus_status tract_build_streamline(struct tract_build *build)
{
    uint64_t needed = build->tractogram.streamline_count + 1;
    if (needed >= UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "streamlines: found more than %u, which are allowed", UINT32_MAX - 1);
    }
    return needed <= build->streamline_capacity && build->tractogram.first ? CONUS_OK
                                                                           : build_grow(build, false, needed);
}

conus_status tract_build_take(struct tractogram *out, struct tract_build *build)
{
    conus_status status = resize_streamlines(build, build->tractogram.streamline_count);
    status = status ? status : resize_points(build, build->tractogram.point_count);
    if (!status) {
        *out = build->tractogram;
        *build = (struct tract_build){0};
    }
    return status;
}
