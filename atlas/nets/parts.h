/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Borders between the points of a grid. Only this folder includes it. */
#ifndef CONUS_ATLAS_NETS_PARTS_H
#define CONUS_ATLAS_NETS_PARTS_H

#include "atlas/atlas.h"

enum { NET_BORDER = 3 }; /**< So many points along each side of a grid are outside of everything. */

/** Middles of cubes, in world mm. */
struct net_grid {
    double start[3], edge; /**< Of the first one; edge of a cube. */
    size_t dim[3], step[3], count;
    uint32_t *objects; /**< [count] What is there; 0 = nothing. */
    float *inside; /**< [count] How far it is inside: at the border this is `level`; NULL = the border is halfway. */
    double level;
};

/** A grid of cubes of @p edge around a box, with nothing in it. */
conus_status net_grid_init(struct net_grid *out, const double low[3], const double high[3], double edge);
void net_grid_finish(struct net_grid *grid);

void net_grid_index(size_t out[3], const struct net_grid *grid, size_t point);
void net_grid_middle(double out[3], const struct net_grid *grid, size_t point);

/** The area of voxels at a world point; 0 = none. Of several volumes the first one that has one there. */
uint32_t net_area_at(const conus_atlas *atlas, const double at[3]);

/** A vertex in each cube of eight points that are not all of one object; around each edge between points of two objects
 * a square of the vertices of the four cubes at it. */
struct net {
    size_t vertex_count, square_count;
    float *vertices; /**< [vertex_count][3] World mm. */
    struct net_square {
        uint32_t objects[2];
        uint32_t corners[4]; /**< Vertices, counter-clockwise as seen from the second object. */
    } * squares;             /**< [square_count] */
};

/** The points along the grid's border have no object, so that every square is whole. CONUS_ERROR_MEMORY. */
conus_status net_find(struct net *out, const struct net_grid *grid);
void net_finish(struct net *net);

#endif
