/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What is worth knowing about a deformation field before it is used. */
#ifndef CONUS_ATLAS_DEFORMATION_DEFORMATION_FACTS_H
#define CONUS_ATLAS_DEFORMATION_DEFORMATION_FACTS_H

#include "atlas/deformation/deformation.h"

struct deformation_facts {
    double farthest;        /**< Longest way of a node, mm.                                             */
    size_t nodes, unstated; /**< Nodes, and those of which the field says nothing.                       */
    size_t cells, folds;    /**< Cells between eight nodes, and those in which the map turns over at a corner (its
                               Jacobian has another sign than the field as a whole, or is 0).             */
    double growth;          /**< What becomes of 1 mm^3, by the affine next to the field.                */
    bool mirrors;           /**< The field as a whole does.                                             */
    bool half_turn;         /**< It turns the whole by about half a circle about z.                      */
};

/** Finds the facts of a measured field. */
conus_status deformation_facts_find(struct deformation_facts *out, const struct deformation *field);

#endif
