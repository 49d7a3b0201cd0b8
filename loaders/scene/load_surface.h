/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A surface as an atlas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_SURFACE_H
#define CONUS_LOADERS_SCENE_LOAD_SURFACE_H

#include "loaders/scene/load_progress.h"

/** Loads the surface @p path: its areas are those of the labels of its vertices (options->labels, else in its own
 * file), or there is one, the whole. The atlas's notes keep the sink. */
conus_status surface_load(conus_atlas **out, const char *path, const struct load_progress *progress);

#endif
