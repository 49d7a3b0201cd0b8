/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a manifest puts around the areas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_CONTEXT_H
#define CONUS_LOADERS_SCENE_LOAD_CONTEXT_H

#include "atlas/atlas.h"
#include "loaders/manifest/manifest.h"

/** Sets the file @p path as @p entry says, but for its transfer function. CONUS_ERROR_DATA also for what is of volumes
 * where it is a surface, the reverse, and a second volume. */
conus_status context_entry_set(conus_atlas *atlas, const struct manifest_context *entry, const char *path,
                               const conus_load_options *options);

/** Notes the transfer function of an entry of the manifest @p path, which has one. CONUS_ERROR_IO where its file is not
 * there. */
conus_status context_entry_transfer(conus_atlas *atlas, const struct manifest_context *context, const char *path);

#endif
