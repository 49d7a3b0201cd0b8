/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A surface as an atlas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_SURFACE_H
#define CONUS_LOADERS_SCENE_LOAD_SURFACE_H

#include "conus/conus.h"

/** Loads the surface @p path: its areas are those of the labels of its vertices (options->labels, else in its own
 * file), or there is one, the whole. */
conus_status surface_load(conus_atlas **out, const char *path, const conus_load_options *options);

#endif
