/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The head in a context. */
#ifndef CONUS_ATLAS_FIT_HEAD_H
#define CONUS_ATLAS_FIT_HEAD_H

#include "atlas/atlas.h"
#include "atlas/volume.h"

enum { HEAD_CELLS = 128 }; /**< Along an axis: of a larger grid every second voxel counts, or every third. */

struct head {
    const struct volume *context; /**< Borrowed. */
    double threshold;             /**< The least value of the head. */
    size_t step[3], dim[3];       /**< Voxels to a cell, and cells. */
    uint8_t *inside;              /**< Per cell. */
};

/** Finds the head: the voxels from a threshold on, by Otsu's method (least variance within both classes, 256 bins), and
 * those that these enclose along two of the grid's three axes: a skull encloses the brain. */
conus_status head_make(struct head *out, const struct volume *context);
void head_finish(struct head *head);

/** Whether the world point @p point is in the context's grid, and if so, whether it is in the head. */
bool head_grid_has(bool *in_head, const struct head *head, const double point[3]);

enum { SURFACE_HEAD_CELLS = 120 }; /**< Voxels along the longest edge of the box around the surfaces. */

/** Fills @p out with 1 in voxels whose centre is in a closed surface of atlas->context_surfaces, and 0 elsewhere: cubes
 * over the box around these surfaces. No values where none is closed. CONUS_ERROR_MEMORY. */
conus_status surface_head_make(struct volume *out, const conus_atlas *atlas);

#endif
