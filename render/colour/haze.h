/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Pathways that are drawn as haze, by colours and opacities of their values (Eq. 8). */
#ifndef CONUS_RENDER_COLOUR_HAZE_H
#define CONUS_RENDER_COLOUR_HAZE_H

#include "atlas/atlas.h"
#include "conus/picture.h"
#include "render/colour/transfer.h"

/** The pathways that are haze, with their transfer functions. */
struct haze_choice {
    struct transfer *transfers; /**< [object_count + 1] in values of the pathway's map; without points: no haze. */
    size_t object_count;
};

/** Haze on a grid: extinction adds up where pathways overlap. */
struct haze_field {
    conus_volume_info info;
    float *texels; /**< [voxels][4] linear R, G, B times the extinction, and the extinction per mm. */
};

/** Reads the choice from @p options. Relative functions span from a pathway's threshold to its largest value.
 * CONUS_ERROR_ARGUMENT for a number that is no pathway. Call haze_choice_finish() in any case. */
conus_status haze_choose(struct haze_choice *out, const conus_atlas *atlas, const conus_renderer_options *options);
void haze_choice_finish(struct haze_choice *choice);

/** Whether the object is haze. */
static inline bool haze_is(const struct haze_choice *choice, size_t number)
{
    return choice && choice->transfers && choice->transfers[number].count > 0;
}

/** The colour, sRGB, and opacity of a pathway that is haze at a place, between voxel centres trilinearly. */
void haze_colour_at(double rgba[4], const conus_atlas *atlas, const struct haze_choice *choice, uint32_t number,
                    const double world[3]);

/** The field of all chosen pathways that are not hidden, on the grid of the first, with a margin of one voxel without
 * haze. No texels if there are none. @p max_memory limits the texels. Call haze_field_finish() in any case. */
conus_status haze_fill(struct haze_field *out, const conus_atlas *atlas, const struct haze_choice *choice,
                       uint64_t max_memory);
void haze_field_finish(struct haze_field *field);

#endif
