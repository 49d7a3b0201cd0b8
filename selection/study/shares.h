/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which shares of a box or tetrahedron lie in which objects of an atlas's volumes: it is cut by the borders of
 * voxels (Eq. 16). */
#ifndef CONUS_SELECTION_STUDY_SHARES_H
#define CONUS_SELECTION_STUDY_SHARES_H

#include "atlas/atlas.h"
#include "base/geometry/math3.h"

/** Called for each piece of a box that lies in the same objects throughout: @p count of them, which may repeat. */
typedef void (*shares_take)(void *user, const uint32_t *objects, size_t count, double share);

/** Volumes whose voxels lie at the same places. */
struct share_grid {
    double from_previous[16]; /**< Index coordinates from those of the grid before; of the first from the box's. */
    size_t end;    /**< End of its volumes in shares.volumes; they begin where those of the grid before end. */
    double dim[3]; /**< The largest of its volumes. */
};

struct shares {
    const struct volume **volumes; /**< [volume_count] Those that can be covered, grid by grid. */
    size_t volume_count;
    struct share_grid *grids; /**< [grid_count] */
    size_t grid_count;
    struct convex_stack stack;
    uint32_t *objects; /**< [object_count] What holds the piece under way; the caller may put some there before. */
    size_t object_count;
    shares_take take;
    void *user;
};

/** @p world_from_box places the boxes. Room is left for @p more objects beside those of volumes. CONUS_ERROR_MEMORY. */
conus_status shares_init(struct shares *out, const conus_atlas *atlas, const double world_from_box[16], size_t more);

void shares_finish(struct shares *shares);

/** Hands the pieces of a box of volume @p share to shares->take; their shares sum to it. CONUS_ERROR_MEMORY. */
conus_status shares_of_box(struct shares *shares, const double low[3], const double high[3], double share);

/** The same of a polyhedron whose edges are on shares->stack. */
conus_status shares_of_convex(struct shares *shares, const struct convex *convex, double share);

#endif
