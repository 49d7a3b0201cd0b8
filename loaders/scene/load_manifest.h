/* SPDX-License-Identifier: BSD-3-Clause */
/** @file From a manifest to the atlas that it describes. */
#ifndef CONUS_LOADERS_SCENE_LOAD_MANIFEST_H
#define CONUS_LOADERS_SCENE_LOAD_MANIFEST_H

#include "base/files/file.h"
#include "loaders/manifest/manifest.h"
#include "loaders/maps/named_maps.h"
#include "loaders/scene/load_progress.h"

/** Loads what the manifest in @p file, the bytes of @p path, names. A path that ends in '/' is a folder for which the
 * manifest was made up. The atlas's notes keep the sink. */
conus_status manifest_load(conus_atlas **out, const char *path, const struct bytes *file,
                           struct load_progress *progress);

/** Loads what @p manifest, which was made up for the file or folder (with '/' at its end) @p path, names. @p names says
 * where the names of its surfaces come from. */
conus_status manifest_load_made(conus_atlas **out, const struct manifest *manifest, const char *path, const char *names,
                                struct load_progress *progress);

/** Loads the volumes of @p path that @p maps names as areas of probabilities, if their values are some. */
conus_status named_maps_load(conus_atlas **out, const char *path, const struct named_maps *maps,
                             struct load_progress *progress);

/** Loads the FSL atlas XML @p path, of another type than Label: its labels are areas of probabilities, of the finest
 * image. */
conus_status probabilities_load(conus_atlas **out, const char *path, struct load_progress *progress);

#endif
