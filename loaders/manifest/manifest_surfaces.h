/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Entries of a manifest for the surfaces in a folder, or for the files of BrainGlobe. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_SURFACES_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_SURFACES_H

#include "loaders/manifest/manifest_draft.h"

enum { MANIFEST_LABEL_STEP = 10000 }; /**< Between the labels of two groups of surfaces. */

#define BRAINGLOBE_ANNOTATION "annotation.tiff"
#define BRAINGLOBE_REFERENCE "reference.tiff"

/** Whether annotation.tiff and structures.json lie in @p folder, which ends in '/'. */
bool brainglobe_has_voxels(struct job *job, const char *folder);

/** The folder, ending in '/', of the atlas that the folder @p path is the meshes of ("atlas/meshes" of "atlas"); NULL
 * if it is that of none. */
const char *brainglobe_of_meshes(struct job *job, const char *path);

/** Adds the surfaces in the folder @p name of the draft's ("" for that itself), or the BrainGlobe atlas that it is. */
void manifest_surfaces_add(struct job *job, struct manifest_draft *draft, const char *name);

/** The scene of the surfaces in @p folder (ending in '/'), or of the BrainGlobe atlas that it is: of its voxels, or of
 * its @p meshes where they are wanted or there is nothing else. */
void scene_of_folder(struct job *job, struct scene *out, const char *folder, bool meshes);

#endif
