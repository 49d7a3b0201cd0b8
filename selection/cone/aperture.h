/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Everything that all cones of one shape have in common, wherever they are: kept from one query to the next. */
#ifndef CONUS_SELECTION_CONE_APERTURE_H
#define CONUS_SELECTION_CONE_APERTURE_H

#include "conus/selection.h"
#include "selection/cone/cone.h"

/** Rays that are walked together are neighbours both ways: pixels come in blocks, and in a block in tiles. */
enum { APERTURE_BLOCK = 16, APERTURE_TILE = 4 };

/** Pixels along an edge up to which weights are not rounded: such a cone is added up in one piece, pixel after pixel.
 */
enum { APERTURE_EXACT_WEIGHTS = 16 };

/** Column of pixel number @p k of a block. */
static inline uint32_t aperture_column(uint32_t k)
{
    uint32_t tile = k / (APERTURE_TILE * APERTURE_TILE);
    return tile % (APERTURE_BLOCK / APERTURE_TILE) * APERTURE_TILE + k % APERTURE_TILE;
}

/** And its row. */
static inline uint32_t aperture_row(uint32_t k)
{
    uint32_t tile = k / (APERTURE_TILE * APERTURE_TILE);
    return tile / (APERTURE_BLOCK / APERTURE_TILE) * APERTURE_TILE + k / APERTURE_TILE % APERTURE_TILE;
}

/** The n x n pixels, row-major. */
struct aperture {
    uint32_t resolution; /**< n */
    conus_aperture shape;
    double angle;
    bool is_wide_square;     /**< Its pixels are those of this angle only (Eq. 15).      */
    bool *in_cone;           /**< cone_has_pixel()                                       */
    uint32_t *square;        /**< cone_square()                                          */
    double *weight;          /**< cone_weight()                                          */
    double *per_depth;       /**< cone_per_depth()                                       */
    uint32_t *inside;        /**< The pixels in the cone, rays.count of them, in the pixels' order. */
    struct device_rays rays; /**< Rays of the pixels in the cone, block by block.             */
    double total_weight;     /**< Sum over the pixels in the cone, in the pixels' order. */
};

/** Whether @p cone has these pixels: if so, another angle changes only their rays and weights. */
bool aperture_has_pixels(const struct aperture *aperture, const struct cone *cone);

/** Whether a pixel in the cone has a neighbour beside, above or below that is not. @p in_cone [n*n]. */
bool aperture_is_border(const bool *in_cone, uint32_t n, uint32_t pixel);

/** Makes it the aperture of @p cone. That takes time only where it had another shape. A zeroed one is ready. */
conus_status aperture_prepare(struct aperture *aperture, const struct cone *cone);
void aperture_finish(struct aperture *aperture);

#endif
