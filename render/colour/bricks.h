/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Chebyshev distance, in bricks of 4 x 4 x 4 voxels, from each brick to the nearest one that shows, for
 * empty-space skipping. */
#ifndef CONUS_RENDER_COLOUR_BRICKS_H
#define CONUS_RENDER_COLOUR_BRICKS_H

#include "atlas/volume.h"

enum { BRICKS_EDGE = 4 };

struct bricks {
    size_t dim[3];     /**< Bricks along i, j, k; the last may reach beyond the grid.                    */
    uint8_t *distance; /**< [dim[0] dim[1] dim[2]], i fastest. 0 where the brick is occupied; else d: bricks that
                          differ by less than d in every index are not (255 at most).                  */
};

void bricks_finish(struct bricks *bricks);

/** Sets the distances, where occupied bricks are 0 and all others 255. */
void bricks_spread(struct bricks *bricks);

#endif
