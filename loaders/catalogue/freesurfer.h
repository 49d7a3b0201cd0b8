/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlases of FreeSurfer's subjects. */
#ifndef CONUS_LOADERS_CATALOGUE_FREESURFER_H
#define CONUS_LOADERS_CATALOGUE_FREESURFER_H

#include "loaders/catalogue/catalogue.h"

/** Adds, of each subject in @p folder, the segmentations in mri/ ("bert.aseg", with FreeSurfer's table of labels if
 * there is one) and the annotations in label/ on the pial surface of their side ("bert.lh.aparc"), or the white one.
 * Nothing is opened. */
conus_status freesurfer_look(conus_catalogue *catalogue, const char *folder);

#endif
