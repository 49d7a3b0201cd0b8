/* SPDX-License-Identifier: BSD-3-Clause */
/** @file An atlas of BrainGlobe's third release as a scene. */
#ifndef CONUS_LOADERS_SCENE_PLAN_BRAINGLOBE_H
#define CONUS_LOADERS_SCENE_PLAN_BRAINGLOBE_H

#include "base/job/job.h"
#include "loaders/manifest/scene.h"

/** Makes the scene of the atlas whose manifest.json is in @p folder (with '/' at its end): the annotation's level of
 * its resolution is the parcellation, named by terminology.csv, and the template's the context, if it was downloaded.
 * Names in it count from *root, a folder with '/' at its end. The job is made of manifest.json then. An annotation that
 * was not downloaded is CONUS_ERROR_IO, whose message says how to do so. What @p out (zeroed) has is the job's. */
void plan_brainglobe(struct job *job, struct scene *out, const char **root, const char *folder);

#endif
