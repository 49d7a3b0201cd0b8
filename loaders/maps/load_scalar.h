/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes whose values are numbers: pathways, the context and regions of interest. */
#ifndef CONUS_LOADERS_MAPS_LOAD_SCALAR_H
#define CONUS_LOADERS_MAPS_LOAD_SCALAR_H

#include "atlas/roi.h"
#include "loaders/manifest/scene.h"
#include "loaders/maps/atlas_on_job.h"

/** The item that @p options describe, which must outlive it; without a file. */
struct scene_item pathway_item(const conus_pathway_options *options);

/** Adds the chosen volume of @p file as a pathway, or its bands as pathways, by the threshold, name, unit and bands of
 * @p item. The atlas gets the job's notes, too. */
void pathway_add(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item);

/** Sets the chosen volume of @p file as the context. @p item says from which value on voxels block; an opacity is an
 * error. The atlas gets the job's notes, too. */
void context_set(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item);

/** Makes a region of interest of the chosen volume of @p file; @p threshold as in conus_roi_options. @p out, the
 * caller's, is set only where all went well. */
void roi_of_volume(struct job *job, conus_roi **out, struct volume_file *file, double threshold);

#endif
