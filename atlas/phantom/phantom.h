/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Phantoms: atlases whose answers follow from a few shapes in closed form. The table behind conus_phantom() holds the
 * shapes as data; painting, the truth file and the tests read the same data. */
#ifndef CONUS_ATLAS_PHANTOM_PHANTOM_H
#define CONUS_ATLAS_PHANTOM_PHANTOM_H

#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "conus/atlas.h"
#include "conus/own.h"

enum { PHANTOM_SHAPES = 6, PHANTOM_AREAS = 6 };

enum phantom_shape_kind { PHANTOM_BALL, PHANTOM_BOX, PHANTOM_RING };

/** A closed set of points in world mm. */
struct phantom_shape {
    enum phantom_shape_kind kind;
    uint32_t label;   /**< Area that it belongs to; several shapes may make up one area.                        */
    uint32_t inside;  /**< Label of the area that it lies wholly inside and takes its place from; 0 = none.     */
    double centre[3]; /**< The middle of the ball, box or ring.                                                 */
    double half[3];   /**< Box: half its edges.                                                                 */
    double radius;    /**< Ball: its radius. Ring: that of its centre line, a circle or an arc of one.          */
    double tube;      /**< Ring: largest distance from the centre line; the ends of an arc are round.           */
    int axis;         /**< Ring: world axis (0 x, 1 y, 2 z) perpendicular to the plane of the centre line.      */
    double from, to;  /**< Ring: ends of the centre line, radians from the next axis (x, y, z, x) towards the one
                           after it; 0 and 2 pi for a whole circle.                                             */
};

struct phantom_area {
    uint32_t label;
    const char *name, *abbreviation;
};

/** An entry of the table: shapes for a cube of PHANTOM_EDGE mm around the world's origin, painted in order. They lie
 * within PHANTOM_EDGE / 2 of the origin, so that a grid turned about it holds them too. */
struct phantom {
    conus_phantom_info info;
    struct phantom_area areas[PHANTOM_AREAS];
    size_t area_count;
    struct phantom_shape shapes[PHANTOM_SHAPES];
    size_t shape_count;
};

/** The table of drawn phantoms: entry @p index, NULL past the last. */
const struct phantom *phantom_entry(size_t index);

#define PHANTOM_EDGE 64.0

/** A phantom on a grid: the shapes scaled to the grid's cube, and the labels painted from them. A voxel has the label
 * of the last shape that contains its centre, so the shapes in the world are the same for every grid. */
struct phantom_drawing {
    const struct phantom *phantom;
    conus_volume_info grid; /**< The affine is rounded to float, as files hold it.                              */
    struct phantom_shape shapes[PHANTOM_SHAPES]; /**< [phantom->shape_count] in world mm.                       */
    uint32_t *labels;                            /**< One per voxel, i fastest.                                 */
};

/** Draws phantom @p kind. CONUS_ERROR_ARGUMENT for an unknown kind or an option out of its range. */
conus_status phantom_draw(struct phantom_drawing *out, const char *kind, const conus_phantom_options *options);
void phantom_drawing_finish(struct phantom_drawing *drawing);

/** Whether @p point lies in @p shape (its border included). */
bool phantom_shape_has(const struct phantom_shape *shape, const double point[3]);

/** Volume of @p shape in mm^3. */
double phantom_shape_volume(const struct phantom_shape *shape);

/** Volume of the area @p label in mm^3: its shapes without those inside it. */
double phantom_area_volume(const struct phantom_drawing *drawing, uint32_t label);

/* The brain phantom: a scene of the size of the paper's (eleven areas, 234,444 triangles, two volumes of 151 x 188 x
 * 154 voxels of 16 bit), in closed form and the same on every run.
 *
 * Shapes are made in a straight space and bent into the world by three shears, one after the other,
 *     x' = x + a sin(k y),  y' = y + a sin(k z),  z' = z + a sin(k x'),  a = 4 mm, k = 2 pi / 32 mm,
 * which keep volumes and have an inverse in closed form. In the straight space the areas are the cells of eleven seeds
 * in an ellipsoid, each smoothly inside its Voronoi cell and with furrows: no two of them touch, none is convex. */

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
