/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes whose values are numbers: pathways, the context and regions of interest. */
#ifndef CONUS_LOADERS_MAPS_LOAD_SCALAR_H
#define CONUS_LOADERS_MAPS_LOAD_SCALAR_H

#include "atlas/atlas.h"
#include "atlas/roi.h"
#include "loaders/volumes/volume_file.h"

/** Adds the chosen volume of @p file as a pathway, or its bands as pathways, by the threshold, name and bands of
 * @p options. On success @p notes, also those of opening the file, move to the atlas; on failure it is as before. */
conus_status pathway_add(conus_atlas *atlas, struct volume_file *file, const conus_pathway_options *options,
                         struct notes *notes);

/** Sets the chosen volume of @p file as the context. @p options say from which value on voxels block; an opacity is an
 * error. Notes and failure as above. */
conus_status context_set(conus_atlas *atlas, struct volume_file *file, const conus_context_options *options,
                         struct notes *notes);

/** Makes a region of interest of the chosen volume of @p file; @p threshold as in conus_roi_options. */
conus_status roi_of_volume(conus_roi **out, struct volume_file *file, double threshold, struct notes *notes);

#endif
