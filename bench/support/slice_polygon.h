/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The polygons of the paper's slicing: where planes across the view cut a volume's box. */
#ifndef CONUS_BENCH_SUPPORT_SLICE_POLYGON_H
#define CONUS_BENCH_SUPPORT_SLICE_POLYGON_H

#include <stdbool.h>

enum { SLICE_CORNERS = 6 };

/** A parallelepiped: corner n differs from corner 0 along the axes whose bits n has. */
struct slice_box {
    double corners[8][3]; /**< To the right, up and ahead of the eye. */
};

/** Cuts the box at @p depth ahead: a convex polygon, its last corner repeated. False where the plane misses the box. */
bool slice_polygon(double out[SLICE_CORNERS][2], const struct slice_box *box, double depth);

#endif
