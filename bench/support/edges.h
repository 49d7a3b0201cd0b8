/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Pictures of identifiers beside the rays engine's: whoever rasterises snaps corners to a grid, which moves
 * edges by up to 1/128 of a pixel. */
#ifndef CONUS_BENCH_SUPPORT_EDGES_H
#define CONUS_BENCH_SUPPORT_EDGES_H

#include "selection/engine/engine.h"

struct bench_differences {
    size_t at_edges; /**< A ray within 1/128 of a pixel of the pixel's centre hits the object that was named. */
    size_t elsewhere;
};

/** Adds the pixels of @p named, [n*n] objects, that are not those of @p hits, which @p rays found for @p cone. */
void bench_compare_pixels(struct bench_differences *sum, struct engine *rays, const struct cone *cone,
                          const uint32_t *named, const uint32_t *hits);

/** Prints them for @p name, of so many pixels, unless there are none; true if all lie at edges. */
bool bench_differences_pass(const struct bench_differences *differences, const char *name, size_t pixels);

#endif
