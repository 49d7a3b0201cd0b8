/* SPDX-License-Identifier: BSD-3-Clause */
/* Whose the streamlines are, which way bundles run, and where along them a point is. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/measure/measure.h"

#include <string.h>

static conus_status find_owners(struct tract_owners *owners, const conus_atlas *atlas, size_t which)
{
    const struct tractogram *tractogram = &atlas->tractograms[which];
    size_t count = tractogram->streamline_count;
    if (tractogram->group_count) {
        size_t members = 0;
        for (size_t g = 0; g < tractogram->group_count; g++) {
            members += tractogram->groups[g].count;
        }
        owners->first = memory_zeroed(count + 1, sizeof *owners->first);
        owners->bundles = memory_raw(members, sizeof *owners->bundles);
        if (!owners->first || !owners->bundles) {
            return CONUS_ERROR_MEMORY;
        }
        for (size_t g = 0; g < tractogram->group_count; g++) {
            for (size_t i = 0; i < tractogram->groups[g].count; i++) {
                owners->first[tractogram->groups[g].members[i] + 1]++; /* bundles of the streamline before */
            }
        }
        for (size_t k = 0; k < tractogram->streamline_count; k++) {
            owners->first[k + 1] += owners->first[k];
        }
    }
    for (uint32_t number = (uint32_t)atlas->area_count + 1; number <= atlas->object_count; number++) {
        const struct tract_group *group = atlas_bundle_group(atlas, number);
        if (atlas_bundle_tractogram(atlas, number) == tractogram && group) {
            for (size_t i = 0; i < group->count; i++) { /* first[k]: where the next bundle of streamline k goes */
                owners->bundles[owners->first[group->members[i]]++] = number;
            }
        } else if (atlas_bundle_tractogram(atlas, number) == tractogram) {
            owners->all = number;
        }
    }
    if (owners->first) { /* they have moved on to where the next streamline's begin */
        memmove(owners->first + 1, owners->first, count * sizeof *owners->first);
        owners->first[0] = 0;
    }
    return CONUS_OK;
}

/* False of a streamline without a point. */
static bool read_ends(double ends[2][3], const struct tractogram *tractogram, uint32_t k)
{
    bool has_points = tractogram->first[k] < tractogram->first[k + 1];
    if (has_points) {
        tractogram_point(ends[0], tractogram, tractogram->first[k]);
        tractogram_point(ends[1], tractogram, tractogram->first[k + 1] - 1);
    }
    return has_points;
}

static void find_longest(double ends[2][3], const struct tractogram *tractogram, const struct tract_group *group)
{
    size_t count = tract_group_count(group, tractogram);
    double longest = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t k = tract_group_member(group, i);
        double length = tractogram_length(tractogram, k);
        if (length > longest && read_ends(ends, tractogram, k)) {
            longest = length;
        }
    }
}

static double distance(const double a[3], const double b[3])
{
    double v[3];
    vec3_sub(v, a, b);
    return vec3_length(v);
}

/* Whether the streamline runs against the bundle's longest one: its like ends are farther from each other. */
static bool is_turned(const struct tractogram *tractogram, uint32_t k, double longest[2][3])
{
    double ends[2][3];
    return read_ends(ends, tractogram, k) && distance(ends[0], longest[1]) + distance(ends[1], longest[0]) <
                                                 distance(ends[0], longest[0]) + distance(ends[1], longest[1]);
}

double tract_index_along(const struct tract_index *index, const conus_atlas *atlas, uint32_t number,
                         const struct tract_part *part)
{
    const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
    double points[2][3];
    double before = 0;
    double whole = 0;
    uint64_t last = tractogram->first[part->streamline + 1] - 1;
    for (uint64_t i = tractogram->first[part->streamline]; i < last; i++) {
        tractogram_point(points[0], tractogram, i);
        tractogram_point(points[1], tractogram, i + 1);
        double length = distance(points[0], points[1]);
        before += i < part->point ? length : i == part->point ? part->s * length : 0;
        whole += length;
    }
    double along = whole > 0 ? fmin(before / whole, 1) : NAN;
    return is_turned(tractogram, part->streamline, index->ends[number]) ? 1 - along : along;
}

conus_status tract_index_create(struct tract_index **out, const conus_atlas *atlas)
{
    struct tract_index *index = memory_zeroed(1, sizeof *index);
    if (!index) {
        return CONUS_ERROR_MEMORY;
    }
    index->of = memory_zeroed(atlas->tractogram_count, sizeof *index->of);
    index->ends = memory_zeroed(atlas->object_count + 1, sizeof *index->ends);
    conus_status status = index->of && index->ends ? CONUS_OK : CONUS_ERROR_MEMORY;
    while (index->tractogram_count < atlas->tractogram_count && !status) {
        size_t which = index->tractogram_count++;
        index->of[which].before = index->streamline_count;
        index->streamline_count += atlas->tractograms[which].streamline_count;
        status = find_owners(&index->of[which], atlas, which);
    }
    for (uint32_t number = (uint32_t)atlas->area_count + 1; number <= atlas->object_count && !status; number++) {
        const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
        if (tractogram) {
            find_longest(index->ends[number], tractogram, atlas_bundle_group(atlas, number));
        }
    }
    if (status) {
        tract_index_destroy(index);
        return status;
    }
    *out = index;
    return CONUS_OK;
}

void tract_index_destroy(struct tract_index *index)
{
    for (size_t i = 0; index && index->of && i < index->tractogram_count; i++) {
        memory_free(index->of[i].first);
        memory_free(index->of[i].bundles);
    }
    if (index) {
        memory_free(index->of);
        memory_free(index->ends);
        memory_free(index);
    }
}
