/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The images that a transform needs: those of FSL's, held against the atlas that it is to move, and grids. */
#ifndef CONUS_LOADERS_MOVED_TRANSFORM_IMAGES_H
#define CONUS_LOADERS_MOVED_TRANSFORM_IMAGES_H

#include "atlas/atlas.h"
#include "base/files/file_sums.h"

/** Warns where less than half of @p atlas, which has not been moved yet, is in the grid of the image that the matrix
 * has in its space: that of `to`, or with `inverse` that of `from`. Both are given. Errors of reading its header. */
conus_status transform_images_note(conus_atlas *atlas, const conus_transform_options *options);

/** Adds the images that the options name to the files that were read, but for those that are a volume of @p atlas,
 * which has their sums. */
conus_status transform_images_sum(struct file_sums *out, const conus_atlas *atlas,
                                  const conus_transform_options *options);

#endif
