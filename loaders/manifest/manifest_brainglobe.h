/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Entries of a manifest for the stacks of a BrainGlobe folder. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_BRAINGLOBE_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_BRAINGLOBE_H

#include "loaders/manifest/manifest_draft.h"

#define BRAINGLOBE_ANNOTATION "annotation.tiff"
#define BRAINGLOBE_REFERENCE "reference.tiff"

/** Whether annotation.tiff and structures.json lie in @p folder, which ends in '/'. */
bool brainglobe_has_voxels(struct job *job, const char *folder);

/** The folder, ending in '/', of the atlas that the folder @p path is the meshes of ("atlas/meshes" of "atlas"); NULL
 * if it is that of none. */
const char *brainglobe_of_meshes(struct job *job, const char *path);

/** Makes annotation.tiff the parcellation and, if there is one, reference.tiff the context. */
void manifest_brainglobe_set(struct job *job, struct manifest_draft *draft);

#endif
