/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A .dlabel.nii as an atlas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_CIFTI_H
#define CONUS_LOADERS_SCENE_LOAD_CIFTI_H

#include "loaders/scene/load_progress.h"

/** Loads the .dlabel.nii @p path, which may choose a map, with the surfaces beside it. The atlas's notes keep the sink.
 */
conus_status cifti_load(conus_atlas **out, const char *path, struct load_progress *progress);

#endif
