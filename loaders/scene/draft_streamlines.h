/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The files of a folder that are no volumes, for a manifest in the making. */
#ifndef CONUS_LOADERS_SCENE_DRAFT_STREAMLINES_H
#define CONUS_LOADERS_SCENE_DRAFT_STREAMLINES_H

#include "loaders/manifest/manifest_draft.h"

/** Appends the file @p name of the folder to "streamlines" if it is a tractogram that loads; of other files
 * draft_transform_say() tells. */
conus_status draft_streamlines_take(struct manifest_draft *draft, const char *name);

#endif
