/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A .dlabel.nii with the surfaces beside it as a scene. */
#ifndef CONUS_LOADERS_SCENE_PLAN_CIFTI_H
#define CONUS_LOADERS_SCENE_PLAN_CIFTI_H

#include "base/job/job.h"
#include "loaders/cifti/cifti_file.h"
#include "loaders/manifest/scene.h"

/** Makes the scene of the map that @p file has chosen: its voxels are the parcellation, each of its surfaces an
 * entry of areas, with the surface beside it that docs/formats.md chooses. Structures without a label in the map are
 * left out. A surface that shares labels with the voxels or with a surface before it gets a label_offset. Names in it
 * are relative to the file's folder. Notes say which surfaces were taken. Errors carry the path. What @p out
 * (zeroed) has is the job's. */
void plan_cifti(struct job *job, struct scene *out, const struct cifti_file *file);

#endif
