/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The volume that a closed surface encloses in a region, as a sum over its triangles (Eq. 10). By the divergence
 * theorem a triangle counts with the flux of a field whose divergence is 1 and that runs along the region's side: (p -
 * apex) / 3 in a cone, (depth - near) axis in a cylinder. */
#ifndef CONUS_SELECTION_REGION_REGION_TRIANGLE_H
#define CONUS_SELECTION_REGION_REGION_TRIANGLE_H

#include "selection/region/region.h"

/** A region as triangles are cut to it; what `region` leads to must outlive it. */
struct region_solid {
    const struct region *region;
    struct region side; /**< The region without its range, in a frame of its own: up, right, axis from its origin. */
};

void region_solid_init(struct region_solid *out, const struct region *region);

/** The contribution of a triangle, in world mm, to a volume, mm^3. Its sum over the triangles of a closed surface is
 * the integral, over the region, of how often the surface winds around a point: the enclosed volume where that is 1
 * inside. Only triangles count that lie in the region or cross a plane that bounds its range; in a ball all do. Closed
 * forms, except arcs on a cone's side, which are met within 1e-10 of themselves. */
double region_triangle(const struct region_solid *solid, double corners[3][3]);

#endif
