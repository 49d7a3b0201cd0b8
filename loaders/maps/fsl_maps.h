/* SPDX-License-Identifier: BSD-3-Clause */
/** @file An FSL atlas of type Probabilistic or Statistic, and the 4-D image with a volume per label. */
#ifndef CONUS_LOADERS_MAPS_FSL_MAPS_H
#define CONUS_LOADERS_MAPS_FSL_MAPS_H

#include "loaders/labels/fsl_atlas.h"
#include "loaders/maps/atlas_on_job.h"

/** What it has is the job's. */
struct fsl_maps {
    const struct label_table *labels; /**< Sorted; label k is volume k - 1 of the image. Never NULL. */
    bool has_background;              /**< Volume 0 is called background and has no label: label k of a summary is
                                         volume k. */
    struct volume_file *image;        /**< A series; NULL after a failure. */
    struct notes *notes;              /**< Notes of opening the image, which nobody has heard yet: for notes_move(). */
};

/** Reads the atlas @p xml and opens @p image, or the finest of its images where that is NULL. @p atlas gets the XML as
 * one of its files, and notes about it. Errors begin with "fsl: ". */
struct fsl_maps fsl_maps_open(struct job *job, conus_atlas *atlas, const char *xml, const char *image,
                              const conus_load_options *options);

#endif
