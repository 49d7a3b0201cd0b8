/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The part of closed surfaces' inside that lies in a region (Eq. 10): their census, as that of voxels is. */
#ifndef CONUS_SELECTION_MEASURE_SOLIDS_H
#define CONUS_SELECTION_MEASURE_SOLIDS_H

#include "atlas/atlas.h"
#include "selection/region/region_triangle.h"

struct solid_block;

/** The surface of an object whose volume is known, and its triangles in blocks. */
struct solid {
    uint32_t object;
    const struct mesh *mesh; /**< The atlas's. */
    uint32_t *triangles;     /**< Its triangles, block by block. */
    struct solid_block *blocks;
    size_t block_count;
};

/** Those of an atlas, which they must not outlive. Only read once they are made. A zeroed one is empty. */
struct solids {
    struct solid *solids;
    size_t count, capacity;
};

/** Appends the surface of @p object, which has a volume (mesh_shape.has_volume). CONUS_ERROR_MEMORY. */
conus_status solids_add(struct solids *solids, uint32_t object, const struct mesh *mesh);
void solids_finish(struct solids *solids);

/** mm^3 of the inside of @p solid in the region: 0 to its whole volume, and 0 for what rounding could be. */
double solid_volume(const struct solid *solid, const struct region_solid *region);

#endif
