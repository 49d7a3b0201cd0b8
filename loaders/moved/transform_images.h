/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The images of an FSL matrix, held against the atlas that it is to move. */
#ifndef CONUS_LOADERS_MOVED_TRANSFORM_IMAGES_H
#define CONUS_LOADERS_MOVED_TRANSFORM_IMAGES_H

#include "atlas/atlas.h"

/** Warns where less than half of @p atlas, which has not been moved yet, is in the grid of the image that the matrix
 * has in its space: that of `to`, or with `inverse` that of `from`. Both are given. Errors of reading its header. */
conus_status transform_images_note(conus_atlas *atlas, const conus_transform_options *options);

#endif
