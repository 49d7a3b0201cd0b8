/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The shape of some objects, as cells at its surface, and its shadow in a picture. World RAS+, mm. */
#ifndef CONUS_VIEWER_PICTURES_CELLS_H
#define CONUS_VIEWER_PICTURES_CELLS_H

#include "viewer/pictures/camera.h"

/** Cubes that have an object's place at their middle, and a neighbour that has not. */
struct cells {
    double (*middles)[3]; /**< [count] */
    size_t count;
    double edge; /**< Edge of each, mm. */
};

/** Finds the shape of all objects that @p wanted, [objects + 1], says, as cuts through @p atlas show them, in up to 64
 * cells along its longest side: where objects overlap, the one in front counts; hidden ones and surfaces that are not
 * closed have no cells. End it with cells_finish(). Errors: as of conus_cutter_draw(). */
conus_status cells_find(struct cells *out, const conus_atlas *atlas, const bool *wanted);
void cells_finish(struct cells *cells); /**< One that is all 0 is fine. */

/** Sets how far from the eye the nearest of them is, mm, in @p nearest, [height width], top row first, where what
 * stands there is farther: INFINITY = nothing. Returns the edge of the nearest cell, pixels. */
double cells_cast(float *nearest, uint32_t width, uint32_t height, const struct cells *cells, const struct eye *eye);

#endif
