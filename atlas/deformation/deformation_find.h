/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The way back through a deformation field. */
#ifndef CONUS_ATLAS_DEFORMATION_DEFORMATION_FIND_H
#define CONUS_ATLAS_DEFORMATION_DEFORMATION_FIND_H

#include "atlas/deformation/deformation.h"

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
