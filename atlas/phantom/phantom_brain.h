/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The brain phantom: a scene of the size of the paper's (eleven areas, 234,444 triangles, two volumes of 151 x 188 x
 * 154 voxels of 16 bit), in closed form and the same on every run.
 *
 * Shapes are made in a straight space and bent into the world by three shears, one after the other,
 *     x' = x + a sin(k y),  y' = y + a sin(k z),  z' = z + a sin(k x'),  a = 4 mm, k = 2 pi / 32 mm,
 * which keep volumes and have an inverse in closed form. In the straight space the areas are the cells of eleven seeds
 * in an ellipsoid, each smoothly inside its Voronoi cell and with furrows: no two of them touch, none is convex. */
#ifndef CONUS_ATLAS_PHANTOM_PHANTOM_BRAIN_H
#define CONUS_ATLAS_PHANTOM_PHANTOM_BRAIN_H

#include "atlas/surface/mesh.h"
#include "conus/atlas.h"

enum { PHANTOM_BRAIN_AREAS = 11, PHANTOM_BRAIN_TRIANGLES = 234444 };

#define PHANTOM_BRAIN_TUBE 5.0 /**< Radius of the pathway at a quarter of its scale, the default threshold, in mm. */

struct phantom_brain_area {
    const char *name, *abbreviation;
    char hemisphere;
    double seed[3]; /**< In the straight space, mm. */
};

/** Area @p index, from 0; its label is index + 1. */
const struct phantom_brain_area *phantom_brain_area(size_t index);

/** The closed surface of area @p index. */
conus_status phantom_brain_mesh(struct mesh *out, size_t index);

/** The grid of both volumes: 151 x 188 x 154 voxels of 1 mm. */
conus_status phantom_brain_grid(conus_volume_info *out);

/** The point of the straight space that is bent to @p world. */
void phantom_brain_straighten(double straight[3], const double world[3]);

/** Grey value of the context at @p world: 0 outside, then a folded rim, the inside, and two dark chambers. */
uint16_t phantom_brain_context(const double world[3]);

/** Value of the pathway at @p world: 65535 on its centre line, an arc of radius 49 mm in a plane of constant y, falling
 * to a quarter at PHANTOM_BRAIN_TUBE from it. */
uint16_t phantom_brain_pathway(const double world[3]);

#endif
