/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A deformation field: a vector at each node of a grid, from which follows where a point goes. */
#ifndef CONUS_ATLAS_DEFORMATION_DEFORMATION_H
#define CONUS_ATLAS_DEFORMATION_DEFORMATION_H

#include "base/status.h"

/** The point with the indices q goes to base q + linear v(q), where v is linear between the eight nodes around q: so
 * displacements and positions, of whatever axes, are kept as their file has them. */
struct deformation {
    size_t dim[3];               /**< Nodes along i, j, k: 2 or more of each.                                       */
    double world_from_voxel[16]; /**< Places of the nodes, mm.                                                    */
    double voxel_from_world[16];
    double base[16];    /**< From indices to mm; 0 where the vectors are positions.                               */
    double linear[16];  /**< From a vector to mm. The last column is 0.                                           */
    float *vectors;     /**< [3 dim[0] dim[1] dim[2]] The three of a node together, i fastest; owned. NaN: the
                           field says nothing there.                                                              */
    bool stays_outside; /**< A point outside of the grid stays where it is; else it goes nowhere.                  */
    bool is_borrowed;   /**< The vectors are not the field's own.                                                 */
    double start[16]; /**< An affine that comes near to the way back, from mm to indices: deformation_measure().      */
    double low[3], high[3]; /**< About the bounds of where nodes go: deformation_measure(). */
};

void deformation_finish(struct deformation *field);

/** Where the world point @p p goes; false, and NaN, where the field says nothing of it. The grid ends half a step
 * outside of its nodes, where the value is that of the border. @p out may be @p p. */
bool deformation_point(double out[3], const struct deformation *field, const double p[3]);

/** Where the point with the indices @p q goes, which is within half a step of the grid; NaN as above. */
void deformation_at(double out[3], const struct deformation *field, const double q[3]);

/** The same, and how that changes with @p q: columns of mm per index. */
void deformation_slope(double out[3], double columns[3][3], const struct deformation *field, const double q[3]);

/** Where a node goes. */
void deformation_node(double out[3], const struct deformation *field, const size_t node[3]);

/** Whether indices are within half a step of the grid. */
bool deformation_holds(const struct deformation *field, const double q[3]);

/** Sets start, low and high. CONUS_ERROR_DATA where no node goes anywhere, or all to a plane. */
conus_status deformation_measure(struct deformation *field);

/** One field of several that points go through. */
struct warp {
    struct deformation field;
    double after[16]; /**< The affine behind it. */
};

/** Where a point goes through all of @p warps, the last one first; as deformation_point(). */
bool warps_point(double out[3], const struct warp *warps, size_t count, const double p[3]);

struct deformation_facts {
    double farthest;        /**< Longest way of a node, mm.                                             */
    size_t nodes, unstated; /**< Nodes, and those of which the field says nothing.                       */
    size_t cells, folds;    /**< Cells between eight nodes, and those in which the map turns over at a corner (its
                               Jacobian has another sign than the field as a whole, or is 0).             */
    double growth;          /**< The volume that 1 mm^3 becomes, by the affine next to the field.         */
    bool mirrors;           /**< The field as a whole does.                                             */
    bool half_turn;         /**< It turns the whole by about half a circle about z.                      */
};

/** Finds the facts of a measured field. */
conus_status deformation_facts_find(struct deformation_facts *out, const struct deformation *field);

#define DEFORMATION_TOLERANCE 1e-6 /**< mm by which the found point may miss, when it goes through the field. */

enum deformation_found {
    DEFORMATION_FOUND,
    DEFORMATION_OUTSIDE, /**< Nothing on the grid goes there.                                                  */
    DEFORMATION_LOST,    /**< The search ended inside of the grid: the field folds there, or it has no values. */
};

/** Finds the world point that goes to @p target: Newton's steps, halved as long as they do not come nearer, from the
 * affine next to the field, then from the nearest of some nodes. @p out is set with DEFORMATION_FOUND; with
 * DEFORMATION_OUTSIDE and stays_outside it is @p target if that lies outside of the grid, and NaN otherwise. Of several
 * points one is found. */
enum deformation_found deformation_find(double out[3], const struct deformation *field, const double target[3]);

#endif
