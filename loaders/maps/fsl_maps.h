/* SPDX-License-Identifier: BSD-3-Clause */
/** @file An FSL atlas of type Probabilistic or Statistic, and the 4-D image with a volume per label. */
#ifndef CONUS_LOADERS_MAPS_FSL_MAPS_H
#define CONUS_LOADERS_MAPS_FSL_MAPS_H

#include "atlas/atlas.h"
#include "loaders/labels/fsl_atlas.h"
#include "loaders/volumes/volume_file.h"

struct fsl_maps {
    struct fsl_atlas atlas;   /**< Its labels, sorted; label k is volume k - 1 of the image. */
    bool has_background;      /**< Volume 0 is called background and has no label: label k of a summary is volume k. */
    struct volume_file image; /**< A series. */
    struct notes notes;       /**< Notes of opening the image. */
};

/** Reads the atlas @p xml and opens @p image, or the finest of its images where that is NULL. @p atlas gets the XML as
 * one of its files, and notes about it. Errors begin with "fsl: ". */
conus_status fsl_maps_open(struct fsl_maps *out, conus_atlas *atlas, const char *xml, const char *image,
                           const conus_load_options *options);
void fsl_maps_finish(struct fsl_maps *maps);

#endif
