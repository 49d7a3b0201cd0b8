/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Moves an atlas by a file. */
#ifndef CONUS_LOADERS_SCENE_LOAD_TRANSFORM_H
#define CONUS_LOADERS_SCENE_LOAD_TRANSFORM_H

#include "atlas/atlas.h"
#include "base/job/job.h"

/** conus_atlas_transform(), but that notes are the job's, and the atlas may have some of them after a failure. */
void transform_load(struct job *job, conus_atlas *atlas, const char *path, const conus_transform_options *options);

#endif
