/* SPDX-License-Identifier: BSD-3-Clause */
/* How areas stand out in a picture with a cone. */
#include "selection/picture/picture_emphasis.h"

#include "base/memory.h"
#include "render/colour/emphasis.h"

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
