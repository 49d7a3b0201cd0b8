/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Smooths the edges of a picture on the CPU: width * height pixels of four floats, of the squares of COLOUR_TILE pixels
 * that a colour_edges is about. edges.comp.glsl does the same on the device, to the bit. */
#ifndef CONUS_RENDER_COLOUR_EDGES_H
#define CONUS_RENDER_COLOUR_EDGES_H

#include "render/colour/colour.h"

/** Squares along so many pixels. */
static inline size_t edges_across(uint32_t pixels)
{
    return (pixels + COLOUR_TILE - 1) / COLOUR_TILE;
}

/** Sets in @p tiles [edges_across(width) * edges_across(height)], row by row, which squares have a pixel that differs
 * from its right or upper neighbour, which may lie in the next one. Returns whether any has. */
bool edges_find(uint32_t *tiles, const float *rgba, uint32_t width, uint32_t height);

/** Mixes what was @p drawn of these squares, the mean of the rays of each pixel, into @p rgba. */
void edges_mix(float *rgba, const float *drawn, const uint32_t *tiles, const struct colour_view *view,
               const struct colour_edges *edges);

#endif
