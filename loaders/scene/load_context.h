/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The contexts around the areas that a manifest names. */
#ifndef CONUS_LOADERS_SCENE_LOAD_CONTEXT_H
#define CONUS_LOADERS_SCENE_LOAD_CONTEXT_H

#include "atlas/atlas.h"
#include "loaders/manifest/manifest.h"

/** Sets the file @p path as @p entry says, without its transfer function. CONUS_ERROR_DATA also for a key of volumes
 * with a surface, a key of surfaces with a volume, and a second volume. */
conus_status context_entry_set(conus_atlas *atlas, const struct manifest_context *entry, const char *path,
                               const conus_load_options *options);

/** Sets the transfer function of @p atlas from an entry, which has one, of the manifest @p path. CONUS_ERROR_IO if its
 * file is not there. */
conus_status context_entry_transfer(conus_atlas *atlas, const struct manifest_context *context, const char *path);

#endif
