/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What all cones of one shape have in common, wherever they are: kept from one query to the next. */
#ifndef CONUS_SELECTION_APERTURE_H
#define CONUS_SELECTION_APERTURE_H

#include "selection/cone.h"

/** Of n x n pixels, row-major. */
struct aperture {
    uint32_t resolution; /**< n */
    conus_aperture shape;
    double angle;
    bool *in_cone;       /**< cone_has_pixel()                                       */
    double *radius;      /**< cone_radius()                                          */
    double *weight;      /**< cone_weight()                                          */
    double total_weight; /**< Of the pixels in the cone, summed in the pixels' order. */
};

/** Makes it that of @p cone, which takes time only where it was that of another shape. A zeroed one is ready. */
conus_status aperture_prepare(struct aperture *aperture, const struct cone *cone);
void aperture_finish(struct aperture *aperture);

#endif
