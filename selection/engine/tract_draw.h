/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Streamlines of the gl engine (Eq. 18): the driver proposes what rays may hit (render/id/tract_pass.h), and
 * tract_rays.h settles it, so that every bit is that of the rays engine. Needs a current context throughout. */
#ifndef CONUS_SELECTION_ENGINE_TRACT_DRAW_H
#define CONUS_SELECTION_ENGINE_TRACT_DRAW_H

#include "render/id/tract_pass.h"
#include "selection/engine/tracts/tract_rays.h"

struct tract_draw;

/** A cone that is not wide, and the hits of its rays. */
struct tract_picture {
    struct tract_query query; /**< Its distances are those of `out`, or NULL where layers are asked for. */
    struct evidence *out;
};

/** @p out is NULL where the driver does not take the streamlines, or they would need more than @p memory_left: then
 * others have to find them. @p rays must outlive it. CONUS_ERROR_MEMORY, CONUS_ERROR_GL. */
conus_status tract_draw_create(struct tract_draw **out, const struct tract_rays *rays, uint64_t *memory_left);
/** NULL is fine. */
void tract_draw_destroy(struct tract_draw *draw);

/** Looks for nearer hits than those that @p pictures, all of one resolution, have, as tract_rays_trace() does. */
conus_status tract_draw_trace(struct tract_draw *draw, const struct tract_picture *pictures, size_t count);

/** Appends all intervals of all rays, as tract_rays_pierce() does; pixels in order. */
conus_status tract_draw_pierce(struct tract_draw *draw, struct layers *out, const struct tract_picture *picture);

/** How many runs the driver has proposed so far, for pixels one by one. */
uint64_t tract_draw_proposals(const struct tract_draw *draw);

#endif
