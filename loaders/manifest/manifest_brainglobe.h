/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Entries of a manifest for the stacks of a BrainGlobe folder. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_BRAINGLOBE_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_BRAINGLOBE_H

#include "loaders/manifest/manifest_draft.h"

#define BRAINGLOBE_ANNOTATION "annotation.tiff"
#define BRAINGLOBE_REFERENCE "reference.tiff"

/** Whether annotation.tiff and structures.json lie in @p folder, which ends in '/'. */
conus_status brainglobe_has_voxels(bool *out, const char *folder);

/** The folder, ending in '/', of the atlas that the folder @p path is the meshes of ("atlas/meshes" of "atlas"); NULL
 * in *out if it is that of none. memory_free() it. */
conus_status brainglobe_of_meshes(char **out, const char *path);

/** Makes annotation.tiff the parcellation and, if there is one, reference.tiff the context. */
conus_status manifest_brainglobe_set(struct manifest_draft *draft);

#endif
