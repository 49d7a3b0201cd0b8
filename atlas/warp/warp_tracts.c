/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines whose points go back through a field. One with a point that has no place is left out whole. */
#include "atlas/atlas.h"
#include "atlas/deformation/deformation.h"
#include "atlas/warp/warp_parts.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { GONE = UINT32_MAX };

void warped_tracts_finish(struct warped_tracts *tracts, size_t count)
{
    for (size_t i = 0; tracts->items && i < count; i++) {
        tractogram_finish(&tracts->items[i]);
    }
    memory_free(tracts->items);
    *tracts = (struct warped_tracts){0};
}

/* Moves the points of streamline @p k behind those of @p out. False where one has no place. */
static bool move_streamline(struct warped_tracts *counts, struct tractogram *out, const struct tractogram *old,
                            uint32_t k, const struct deformation *fields, size_t count)
{
    bool whole = true;
    float *to = out->points + 3 * out->point_count;
    for (uint64_t i = old->first[k]; i < old->first[k + 1]; i++, to += 3) {
        double point[3];
        tractogram_point(point, old, i);
        enum deformation_found found = deformations_find(point, fields, count, point);
        counts->counts.points++;
        counts->counts.outside += found == DEFORMATION_OUTSIDE;
        counts->counts.lost += found == DEFORMATION_LOST;
        for (int a = 0; a < 3; a++) {
            whole = whole && found != DEFORMATION_LOST && fabs(point[a]) <= TRACT_COORDINATE_LIMIT; /* NaN is not */
            to[a] = (float)point[a];
        }
    }
    return whole;
}

static conus_status cut_scalar(struct tract_scalar *out, const struct tract_scalar *scalar, const uint32_t *numbers,
                               const struct tractogram *old)
{
    size_t count = scalar->per_point ? old->point_count : old->streamline_count;
    out->per_point = scalar->per_point;
    out->components = scalar->components;
    out->name = memory_text(scalar->name, strlen(scalar->name));
    out->values = memory_raw(count, scalar->components * sizeof *out->values);
    if (!out->name || !out->values) {
        return CONUS_ERROR_MEMORY;
    }
    float *to = out->values;
    for (size_t k = 0; k < old->streamline_count; k++) {
        uint64_t from = scalar->per_point ? old->first[k] : k;
        uint64_t end = scalar->per_point ? old->first[k + 1] : k + 1;
        size_t size = (end - from) * scalar->components;
        if (numbers[k] != GONE) {
            memcpy(to, scalar->values + from * scalar->components, size * sizeof *to);
            to += size;
        }
    }
    return CONUS_OK;
}

static conus_status cut_group(struct tract_group *out, const struct tract_group *group, const uint32_t *numbers)
{
    out->name = memory_text(group->name, strlen(group->name));
    out->members = memory_raw(group->count, sizeof *out->members);
    if (!out->name || !out->members) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < group->count; i++) {
        if (numbers[group->members[i]] != GONE) {
            out->members[out->count++] = numbers[group->members[i]];
        }
    }
    return CONUS_OK;
}

static conus_status cut_lists(struct tractogram *out, const uint32_t *numbers, const struct tractogram *old)
{
    out->path = memory_text(old->path, strlen(old->path));
    out->scalars = memory_zeroed(old->scalar_count, sizeof *out->scalars);
    out->groups = memory_zeroed(old->group_count, sizeof *out->groups);
    conus_status status = out->path && out->scalars && out->groups ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < old->scalar_count && !status; i++) {
        status = cut_scalar(&out->scalars[out->scalar_count++], &old->scalars[i], numbers, old);
    }
    for (size_t i = 0; i < old->group_count && !status; i++) {
        status = cut_group(&out->groups[out->group_count++], &old->groups[i], numbers);
    }
    memcpy(out->format, old->format, sizeof out->format);
    memcpy(out->sha256, old->sha256, sizeof out->sha256);
    out->radius = old->radius;
    return status;
}

/* A tractogram that stays whole gets only points and tree, as bundles_move() makes them. */
static conus_status settle(struct tractogram *out, const uint32_t *numbers, const struct tractogram *old)
{
    if (old->streamline_count && !out->streamline_count) {
        return fail(CONUS_ERROR_DATA, "%s: no streamline is where the field leads to", old->path);
    }
    conus_status status = out->streamline_count < old->streamline_count ? cut_lists(out, numbers, old) : CONUS_OK;
    status = status ? status : tractogram_grow_tree(out);
    if (!status && out->streamline_count == old->streamline_count) {
        memory_free(out->first);
        out->first = NULL;
    }
    return status;
}

static conus_status move_tractogram(struct warped_tracts *counts, struct tractogram *out, const struct tractogram *old,
                                    const struct deformation *fields, size_t count)
{
    uint32_t *numbers = memory_raw(old->streamline_count, sizeof *numbers);
    out->points = memory_raw(old->point_count, 3 * sizeof *out->points);
    out->first = memory_zeroed(old->streamline_count + 1, sizeof *out->first);
    conus_status status = numbers && out->points && out->first ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        for (uint32_t k = 0; k < old->streamline_count; k++) {
            bool whole = move_streamline(counts, out, old, k, fields, count);
            numbers[k] = whole ? (uint32_t)out->streamline_count++ : GONE;
            if (whole) {
                out->point_count += old->first[k + 1] - old->first[k];
                out->first[out->streamline_count] = out->point_count;
            }
        }
        counts->counts.wholes += old->streamline_count;
        counts->counts.cut += old->streamline_count - out->streamline_count;
        status = settle(out, numbers, old);
    }
    memory_free(numbers);
    return status;
}

conus_status warped_tracts_init(struct warped_tracts *out, const conus_atlas *atlas, const struct deformation *fields,
                                size_t count)
{
    struct warped_tracts tracts = {.items = memory_zeroed(atlas->tractogram_count, sizeof *tracts.items)};
    conus_status status = tracts.items ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < atlas->tractogram_count; i++) {
        status = move_tractogram(&tracts, &tracts.items[i], &atlas->tractograms[i], fields, count);
    }
    return GIVE(status, out, tracts, warped_tracts_finish(&tracts, atlas->tractogram_count));
}
