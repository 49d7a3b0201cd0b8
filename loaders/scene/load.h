/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Any file or folder as an atlas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_H
#define CONUS_LOADERS_SCENE_LOAD_H

#include "atlas/atlas.h"

/** conus_atlas_load() of a path without template; @p options is not NULL, and of this version. */
conus_status atlas_load_files(conus_atlas **out, const char *path, const conus_load_options *options);

#endif
