/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes whose values are numbers: pathways, the context and regions of interest. */
#ifndef CONUS_LOADERS_MAPS_LOAD_SCALAR_H
#define CONUS_LOADERS_MAPS_LOAD_SCALAR_H

#include "atlas/roi.h"
#include "loaders/maps/atlas_on_job.h"

/** Adds the chosen volume of @p file as a pathway, or its bands as pathways, by the threshold, name and bands of
 * @p options. The atlas gets the job's notes, too. */
void pathway_add(struct job *job, conus_atlas *atlas, struct volume_file *file, const conus_pathway_options *options);

/** The same of the file @p path: conus_atlas_add_pathway(), but that notes are the job's. */
void pathway_load(struct job *job, conus_atlas *atlas, const char *path, const conus_pathway_options *options);

/** Sets the chosen volume of @p file as the context. @p options say from which value on voxels block; an opacity is an
 * error. The atlas gets the job's notes, too. */
void context_set(struct job *job, conus_atlas *atlas, struct volume_file *file, const conus_context_options *options);

/** Makes a region of interest of the chosen volume of @p file; @p threshold as in conus_roi_options. @p out, the
 * caller's, is set only where all went well. */
void roi_of_volume(struct job *job, conus_roi **out, struct volume_file *file, double threshold);

#endif
