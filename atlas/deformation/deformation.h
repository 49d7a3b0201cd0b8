/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A deformation field: vectors at the nodes of a grid say where a point goes. */
#ifndef CONUS_ATLAS_DEFORMATION_DEFORMATION_H
#define CONUS_ATLAS_DEFORMATION_DEFORMATION_H

#include "base/status.h"

/** The point with the indices q goes to base q + linear v(q), where v is linear between the eight nodes around q: so
 * displacements and positions, of whatever axes, are kept as their file has them. */
struct deformation {
    size_t dim[3];               /**< Nodes along i, j, k: 2 or more of each.                                       */
    double world_from_voxel[16]; /**< Places of the nodes, mm.                                                    */
    double voxel_from_world[16];
    double base[16];        /**< From indices to mm; 0 where the vectors are positions.                               */
    double linear[16];      /**< From a vector to mm. The last column is 0.                                           */
    float *vectors;         /**< [3 dim[0] dim[1] dim[2]] The three of a node together, i fastest; owned. NaN: the
                               field says nothing there.                                                              */
    float *rest;            /**< The same: what doubles have beyond the vectors' single precision; NULL = nothing.    */
    double *coefficients;   /**< [3][dim[0] dim[1] dim[2]] In place of vectors, those of x, then y, then z, i fastest;
                               owned. v(q) is their sum by cubic B-splines of the 64 nodes around q. The grid then has
                               4 nodes or more along each axis, and ends at the last but one. */
    bool stays_outside;     /**< Outside of the grid a vector is 0: a point q goes to base q. Else it has no image.   */
    bool is_borrowed;       /**< Vectors, rest and coefficients are not the field's own.                              */
    double start[16];       /**< An affine near the inverse of the field, from mm to indices: deformation_measure(). */
    double low[3], high[3]; /**< Approximate bounds of the nodes' positions: deformation_measure(). */
};

void deformation_finish(struct deformation *field);

/** The image of the world point @p p; false, and NaN, where the field has no value. The grid of vectors ends half a
 * step beyond its nodes, where the value is that of the border. @p out may be @p p. */
bool deformation_point(double out[3], const struct deformation *field, const double p[3]);

/** The image of the point with the indices @p q, which deformation_holds(); NaN as above. */
void deformation_at(double out[3], const struct deformation *field, const double q[3]);

/** The same, and its derivative by @p q: columns of mm per index. */
void deformation_slope(double out[3], double columns[3][3], const struct deformation *field, const double q[3]);

/** Whether indices are in the grid. */
bool deformation_holds(const struct deformation *field, const double q[3]);

/** Sets start, low and high. CONUS_ERROR_DATA if no node has an image, or all lie in a plane. */
conus_status deformation_measure(struct deformation *field);

/** One of several fields that points go through. */
struct warp {
    struct deformation field;
    double after[16]; /**< The affine behind it. */
};

/** The image of a point through all of @p warps, the last one first; as deformation_point(). */
bool warps_point(double out[3], const struct warp *warps, size_t count, const double p[3]);

struct deformation_facts {
    double farthest;        /**< Longest displacement of a node, mm. */
    size_t nodes, unstated; /**< Nodes, and those without a value; of splines every half step. */
    size_t cells, folds; /**< Cells between eight of these, and those in which the map folds at a corner (its Jacobian
                              has another sign than the field as a whole, or is 0). */
    double growth;       /**< The volume that 1 mm^3 becomes, by the affine next to the field.         */
    bool mirrors;        /**< The field as a whole mirrors. */
    bool half_turn;      /**< The field as a whole turns by about half a circle about z. */
};

/** Finds the facts of a measured field. */
conus_status deformation_facts_find(struct deformation_facts *out, const struct deformation *field);

#define DEFORMATION_TOLERANCE 1e-6 /**< mm by which the image of the found point may miss the target. */

enum deformation_found {
    DEFORMATION_FOUND,
    DEFORMATION_OUTSIDE, /**< No point of the grid has this image. */
    DEFORMATION_LOST,    /**< The search ended inside of the grid: the field folds there, or has no values. */
};

/** Makes affines before and after the field a part of the field. */
void deformation_fold(struct deformation *field, const double before[16], const double after[16]);

/** Finds the world point whose image is @p target: Newton's steps, halved until they come nearer, from the affine near
 * the inverse, then from the nearest of some nodes. @p out is set with DEFORMATION_FOUND; with DEFORMATION_OUTSIDE and
 * stays_outside it is the point outside of the grid that goes there, and NaN where there is none. One of several points
 * is found. */
enum deformation_found deformation_find(double out[3], const struct deformation *field, const double target[3]);

/** The same back through @p count fields, the first one first. DEFORMATION_OUTSIDE if it was outside of any. */
enum deformation_found deformations_find(double out[3], const struct deformation *fields, size_t count,
                                         const double target[3]);

#endif
