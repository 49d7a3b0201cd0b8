/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The names that BIDS derivatives have for transforms:
 * "sub-01_from-T1w_to-MNI152NLin2009cAsym_mode-image_xfm.h5" of fMRIPrep moves images of the first space to the second,
 * and so points of the second to the first. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_NAME_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_NAME_H

#include "base/text.h"

/** The spaces from which and to which @p path moves points, by its name; false where that does not say so. */
bool transform_name_points(struct text *from, struct text *to, const char *path);

/** Whether a space is called like one of the MNI's. */
bool transform_name_is_mni(struct text space);

#endif
