/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A view of the colour pass as its shader reads it, and the planes that the pass samples. */
#ifndef CONUS_RENDER_COLOUR_COLOUR_VIEW_H
#define CONUS_RENDER_COLOUR_COLOUR_VIEW_H

#include "render/colour/colour.h"

/** The shader's uniform block View, in std140's layout. */
struct colour_view_block {
    float context_from_camera[16], areas_from_camera[16], world_from_camera[16];
    float context_bricks[4], areas_bricks[4];
    float lens[4], middle[4], planes[4], light[4];
    float apex[4], axis[4], cone_shape[4], cone_colour[4], line[4];
    int32_t counts[4];
    float markers[COLOUR_MARKER_LIMIT][4], marker_colours[COLOUR_MARKER_LIMIT][4];
    float haze_from_camera[16], haze_shape[4], pale[4];
};

/** The planes of Eq. 7 over the joint depth range of the volumes: @p count of them, 0 = slices_default() of the finest
 * volume. */
struct slices colour_pass_slices(const struct colour_pass *pass, const struct camera *camera, uint32_t count);

/** Fills a zeroed @p block, but for what counts meshes and tiles. */
void colour_view_pack(struct colour_view_block *block, const struct colour_pass *pass, const struct colour_view *view);

#endif
