/* SPDX-License-Identifier: BSD-3-Clause */
/* How areas stand out in a picture with a cone. */
#include "selection/picture/picture.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "conus/own.h"
#include "render/colour/colour.h"

#include <string.h>

static uint32_t group_of(const conus_selection *selection, uint32_t object)
{
    return selection->group ? selection->group[object] : object;
}

uint8_t *picture_emphasis(const conus_selection *selection, uint32_t chosen)
{
    size_t count = selection->atlas->object_count + 1;
    size_t pixels = (size_t)selection->cone.resolution * selection->cone.resolution;
    uint8_t *emphasis = memory_zeroed(count, sizeof *emphasis);
    for (size_t i = 0; emphasis && i < selection->layers.count; i++) {
        const conus_interval *interval = &selection->layers.intervals[i];
        if (selection->in_cone[interval->pixel]) {
            emphasis[group_of(selection, interval->object)] = EMPHASIS_HATCHED;
        }
    }
    for (size_t p = 0; emphasis && p < pixels; p++) {
        if (selection->in_cone[p]) {
            emphasis[group_of(selection, selection->evidence.object[p])] = EMPHASIS_FULL;
        }
    }
    for (size_t i = 0; emphasis && selection->region.shape == REGION_BALL && i < conus_selection_count(selection);
         i++) {
        emphasis[conus_selection_result(selection, i)->object] = EMPHASIS_FULL; /* it has no pixels */
    }
    for (uint32_t object = 1; emphasis && object < count; object++) {
        emphasis[object] = emphasis[group_of(selection, object)];
    }
    for (uint32_t object = 1; emphasis && chosen && object < count; object++) {
        if (emphasis[object] == EMPHASIS_PALE && atlas_is_below(selection->atlas, object, chosen)) {
            emphasis[object] = EMPHASIS_FULL;
        }
    }
    return emphasis;
}

double picture_cone_depth(const conus_selection *selection)
{
    const double *m = selection->cone.pose.world_from_device;
    double depth = -INFINITY;
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        double offset[3];
        if (result->object && result->pixels) {
            vec3_sub(offset, result->contact, m + 12);
            depth = fmax(depth, -vec3_dot(offset, m + 8));
        }
    }
    return depth;
}

bool picture_has_ranks(const conus_selection *selection, bool own_colours)
{
    return selection && !own_colours && !selection->atlas->has_palette;
}

uint32_t *picture_ranks(const conus_selection *selection)
{
    const size_t count = selection->atlas->object_count + 1;
    uint32_t *ranks = memory_zeroed(count, sizeof *ranks);
    for (size_t i = 0; ranks && i < conus_selection_count(selection); i++) {
        const uint32_t object = conus_selection_result(selection, i)->object;
        ranks[object] = (uint32_t)conus_selection_rank(selection, object);
    }
    for (uint32_t object = 1; ranks && object < count; object++) {
        ranks[object] = ranks[group_of(selection, object)];
    }
    return ranks;
}

static bool is_taken(const uint8_t rgb[3], const uint8_t (*taken)[3], size_t count)
{
    bool found = false;
    for (size_t i = 0; i < count && !found; i++) {
        found = memcmp(taken[i], rgb, 3) == 0;
    }
    return found;
}

/* Those of the atlas's palette: what has a rank has a colour that nothing with a better rank has, its own or the first
 * such one, while there are some. */
static conus_status colour_by_palette(uint8_t (*rgb)[3], const uint32_t *ranks, const conus_atlas *atlas)
{
    const size_t objects = atlas->object_count;
    uint8_t(*taken)[3] = memory_raw(objects + 1, sizeof *taken);
    size_t count = 0;
    if (!taken) {
        return CONUS_ERROR_MEMORY;
    }
    memset(rgb[0], 0, sizeof *rgb);
    for (size_t n = 1; n <= objects; n++) {
        memcpy(rgb[n], atlas->objects[n - 1].rgb, 3);
    }
    for (uint32_t rank = 1; rank <= objects; rank++) {
        size_t first = 0;
        for (size_t n = 1; n <= objects; n++) {
            if (ranks[n] == rank && first) {
                memcpy(rgb[n], rgb[first], 3);
            } else if (ranks[n] == rank) {
                size_t free = 0;
                while (free < objects && is_taken(rgb[n], (const uint8_t(*)[3])taken, count)) {
                    memcpy(rgb[n], atlas->objects[free++].rgb, 3);
                }
                if (is_taken(rgb[n], (const uint8_t(*)[3])taken, count)) {
                    memcpy(rgb[n], atlas->objects[n - 1].rgb, 3);
                }
                memcpy(taken[count++], rgb[n], 3);
                first = n;
            }
        }
    }
    memory_free(taken);
    return CONUS_OK;
}

uint8_t (*picture_rank_colours(const uint32_t *ranks, const conus_atlas *atlas, unsigned not_hit, const bool *listed,
                               const conus_selection *selection))[3]
{
    uint8_t(*rgb)[3] = memory_raw(atlas->object_count + 1, sizeof *rgb);
    const bool has_palette = rgb && ranks && atlas->has_palette;
    if (has_palette && colour_by_palette(rgb, ranks, atlas)) {
        memory_free(rgb);
        return NULL;
    }
    for (size_t object = 0; rgb && !has_palette && object <= atlas->object_count; object++) {
        const uint32_t rank = ranks ? ranks[object] : 0;
        look_ranked(rgb[object], rank, rank ? conus_selection_weight(selection, (uint32_t)object) : 1, not_hit);
    }
    for (size_t object = 1; rgb && listed && object <= atlas->object_count; object++) {
        if (listed[object] && !(ranks && ranks[object])) {
            memcpy(rgb[object], atlas->objects[object - 1].rgb, sizeof *rgb);
        }
    }
    return rgb;
}
