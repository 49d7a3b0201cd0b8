/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The transforms of a manifest are applied. */
#ifndef CONUS_LOADERS_MOVED_MANIFEST_MOVE_H
#define CONUS_LOADERS_MOVED_MANIFEST_MOVE_H

#include "loaders/manifest/manifest.h"

/** Moves all that @p atlas has by the transforms of @p manifest, the file @p path; points go through the first one
 * first. @p max_memory as in conus_load_options. Errors of conus_atlas_transform(), with the key; the atlas may have
 * gone through some of them then. */
conus_status manifest_move(conus_atlas *atlas, const struct manifest *manifest, const char *path, uint64_t max_memory);

#endif
