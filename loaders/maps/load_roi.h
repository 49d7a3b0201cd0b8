/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Regions of interest. */
#ifndef CONUS_LOADERS_SCENE_LOAD_ROI_H
#define CONUS_LOADERS_SCENE_LOAD_ROI_H

#include "atlas/roi.h"
#include "loaders/volumes/volume_file.h"

/** Makes a region of the chosen volume of @p file; @p threshold as of conus_roi_options. */
conus_status roi_of_volume(conus_roi **out, struct volume_file *file, double threshold, struct notes *notes);

#endif
