/* SPDX-License-Identifier: BSD-3-Clause */
/** @file OME's metadata of a Zarr group: the levels of an image and where they lie. */
#ifndef CONUS_LOADERS_ZARR_OME_H
#define CONUS_LOADERS_ZARR_OME_H

#include "base/job/job.h"

struct ome_level {
    char *path;      /**< Path of its array, below the group's folder. */
    double scale[3]; /**< mm a voxel along the axes of space, in their order; 0 = not stated, or without a unit. */
    double translation[3]; /**< mm: where the centre of the first voxel lies. */
};

struct ome {
    struct ome_level *levels;
    size_t count;
    size_t rank;         /**< Axes; 0 = not stated. */
    char orientation[4]; /**< Where the axes of space start, "asr"; empty = not stated.  */
};

/** Parses zarr.json of a group (OME 0.5, 0.6), or .zattrs (OME up to 0.4). No image in it is CONUS_ERROR_DATA; @p out
 * has no levels then, else they are the job's. */
void ome_parse(struct job *job, struct ome *out, struct text text);

#endif
