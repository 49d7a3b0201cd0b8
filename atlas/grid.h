/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Numbers on a voxel grid, made to be written into a file: a mask, labels, values (conus_grid). */
#ifndef CONUS_ATLAS_GRID_H
#define CONUS_ATLAS_GRID_H

#include "base/status.h"

struct conus_grid {
    conus_grid_view view; /**< data and description are owned.                                            */
    void *data;           /**< What view.data is: size bytes a voxel, in this machine's byte order.          */
    size_t size;          /**< Bytes of a number.                                                            */
    bool labels;          /**< The numbers are labels.                                                       */
};

/** Zeros on the grid of @p info. @p description is copied. */
conus_status grid_create(conus_grid **out, const conus_volume_info *info, conus_number number, const char *description);

#endif
