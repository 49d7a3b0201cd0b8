/* SPDX-License-Identifier: BSD-3-Clause */
/** @file From a scene to the atlas that it describes. */
#ifndef CONUS_LOADERS_SCENE_SCENE_LOAD_H
#define CONUS_LOADERS_SCENE_SCENE_LOAD_H

#include "base/files/file.h"
#include "loaders/manifest/scene.h"
#include "loaders/maps/named_maps.h"
#include "loaders/scene/load_progress.h"

/** Loads what the manifest in @p file, the bytes of @p path, names. What the job has noted and read before comes behind
 * the atlas's own. */
void manifest_load(struct load *load, const char *path, const struct bytes *file);

/** Loads @p scene, which was made up for the file or folder (with '/' at its end) @p path, likewise. @p names says
 * where the names of its surfaces come from. NULL: it is one file that is ATLAS, which no message calls a manifest. */
void scene_load(struct load *load, const struct scene *scene, const char *path, const char *names);

/** Adds what @p item describes of the file @p path, and paths that it has, which are from here, to @p atlas, which is
 * unchanged on failure. Of @p options the log and max_memory count. */
conus_status scene_add_item(conus_atlas *atlas, const char *path, const struct scene_item *item,
                            const conus_load_options *options);

/** Loads the volumes of @p path that @p maps names as areas of probabilities, if their values are some. */
void named_maps_load(struct load *load, const char *path, const struct named_maps *maps);

/** Loads the FSL atlas XML @p path, of another type than Label: its labels are areas of probabilities, of the finest
 * image. */
void probabilities_load(struct load *load, const char *path);

#endif
