/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Surfaces of all areas of an atlas at once, as a graphics processor takes them. */
#ifndef CONUS_ATLAS_NETS_NETS_H
#define CONUS_ATLAS_NETS_NETS_H

#include "conus/atlas.h"

/** Vertices of all areas and bundles, each of one, and triangles as three of them, counter-clockwise from outside. */
struct nets {
    size_t vertex_count;
    float *positions;  /**< [vertex_count][3] World mm. */
    int8_t *normals;   /**< [vertex_count][4] 127 is a length of 1; the last is 0. */
    uint16_t *objects; /**< [vertex_count] The number of the vertex's area. */
    size_t corner_count;
    uint32_t *corners; /**< [corner_count] Vertices of the triangles, area by area: each surface whole. */
    uint32_t *first;   /**< [object_count + 2] corners[first[k]] to before corners[first[k + 1]] are of object k. */
    size_t outer_count;
    uint32_t *outer; /**< [outer_count] The same for the triangles that face no other area, of all areas. */
    bool is_closed;  /**< Every surface is: none is an area's own mesh or a bundle. */
};

/** Makes them. Areas of voxels: surface nets of a grid of cubes, of which at most @p cells lie along the atlas and none
 * is smaller than the smallest voxel; neighbours share their border. An area that no cube's middle hits gets the cubes
 * of its voxels, but for those that another such area has taken. Areas that are meshes: as they are. Bundles: a band as
 * wide as the ray's reach along each streamline; of more than 2,000 every second, third, ... one of each bundle, and of
 * each at most 40 points, the ends among them. Areas of probabilities and pathways have none. Hidden objects have none.
 * CONUS_ERROR_UNSUPPORTED from 65,536 objects on; CONUS_ERROR_ARGUMENT if nothing has a surface; CONUS_ERROR_MEMORY. */
conus_status nets_make(struct nets *out, const conus_atlas *atlas, uint32_t cells);
void nets_finish(struct nets *nets);

#endif
