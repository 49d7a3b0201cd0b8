/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The part of a segment that lies in a region, and whether a box lies in it (Eq. 19). Every region is convex, so that
 * one piece of a segment lies in it. */
#ifndef CONUS_SELECTION_MEASURE_REGION_SEGMENT_H
#define CONUS_SELECTION_MEASURE_REGION_SEGMENT_H

#include "atlas/tracts/tract_tree.h"
#include "selection/region/region.h"

/** The part from s = @p out [0] to @p out [1] of the segment from ends[0] (s = 0) to ends[1] (s = 1), world mm, that
 * lies in the region; false where none does. @p inside: what region_has() says of the two ends. The segment comes in
 * where region_has() says so of an end or of the middle of the part that is solved for. Where it comes in and out is
 * met within 1e-12 of the coordinates' size, in mm. */
bool region_segment(double out[2], const struct region *region, double ends[2][3], const bool inside[2]);

/** Cuts @p s to where the line @p v + s @p u, both from the region's origin, lies in it; false where that leaves
 * nothing.
 */
bool region_line(double s[2], const struct region *region, const double v[3], const double u[3]);

/** Where the box, its border included, lies. Outside: region_has() holds at none of its points, and no segment in it
 * comes in; inside: it holds at all of them. A box at the border may get TRACT_PERHAPS either way. */
enum tract_answer region_box(const struct region *region, const double low[3], const double high[3]);

#endif
