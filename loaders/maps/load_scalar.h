/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes whose values are numbers: pathways and the context. */
#ifndef CONUS_LOADERS_SCENE_LOAD_SCALAR_H
#define CONUS_LOADERS_SCENE_LOAD_SCALAR_H

#include "atlas/atlas.h"
#include "loaders/volumes/volume_file.h"

/** Adds the chosen volume of @p file as a pathway, or its bands as pathways: threshold, name and bands of @p options
 * count. On success the atlas has @p notes, those of opening the file, too; on failure it is as before. */
conus_status pathway_add(conus_atlas *atlas, struct volume_file *file, const conus_pathway_options *options,
                         struct notes *notes);

/** Sets the chosen volume of @p file as the context: from which value on voxels block, and that there is no opacity, is
 * read of @p options. Notes and failure as above. */
conus_status context_set(conus_atlas *atlas, struct volume_file *file, const conus_context_options *options,
                         struct notes *notes);

#endif
