/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The names that BIDS derivatives have for transforms:
 * "sub-01_from-T1w_to-MNI152NLin2009cAsym_mode-image_xfm.h5" of fMRIPrep moves images of the first space to the second,
 * and so points of the second to the first. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_NAME_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_NAME_H

#include "base/text.h"

/** Finds from the name @p path between which spaces it moves points; false where the name does not say. */
bool transform_name_points(struct text *from, struct text *to, const char *path);

/** What ANTs calls its files. */
enum ants_kind { ANTS_NONE, ANTS_AFFINE, ANTS_WARP, ANTS_INVERSE_WARP, ANTS_COMPOSITE };

/** The kind of file by its name @p path ("out_1InverseWarp.nii.gz"), and what of the path all files of a registration
 * share ("out_"). */
enum ants_kind transform_name_ants(struct text *prefix, const char *path);

/** Whether the name of a space is one of the MNI's. */
bool transform_name_is_mni(struct text space);

#endif
