/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * BrainGlobe's metadata.json, and where its arrays lie. Axis 0 of an array is the page of a TIFF stack, axis 1 the row,
 * axis 2 the column. The world's origin is the corner of the grid at which all three axes start. */
#ifndef CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_METADATA_H
#define CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_METADATA_H

#include "base/job/job.h"

enum { BRAINGLOBE_ORIENTATION = 9 }; /**< Bytes of an orientation, cut off if it is longer than any can be. */

/** Values per axis of the array; empty or 0 where the file has none. */
struct brainglobe_metadata {
    char orientation[BRAINGLOBE_ORIENTATION]; /**< "asr": where the axes start. */
    double resolution[3];                     /**< Micrometres a voxel.         */
    uint64_t shape[3];                        /**< Voxels.                      */
    bool is_allen_mouse;                      /**< The name says so.            */
};

/** Takes "orientation", "resolution", "shape" and "name" of the object @p text; the rest of @p out stays. Damaged JSON,
 * and a value of another kind than these have, is CONUS_ERROR_DATA: things would lie anywhere. */
void brainglobe_metadata_parse(struct job *job, struct brainglobe_metadata *out, struct text text);

/** Likewise for the file metadata.json beside @p path (in it, where it ends in '/'), of which the result is made; false
 * where there is no such file. */
bool brainglobe_metadata_take(struct job *job, struct brainglobe_metadata *out, const char *path);

/** The matrix from (axis 0, axis 1, axis 2), counted from the corner in units of @p scale[axis] mm, to the world. Three
 * letters, one each of R or L, A or P, S or I, are needed: else CONUS_ERROR_DATA. */
conus_status brainglobe_axes(double world_from_axes[16], const char *orientation, const double scale[3]);

/** The matrix from the voxel (column, row, page), whose whole numbers are centres, to the world: half a voxel from the
 * corner. */
conus_status brainglobe_voxels(double world_from_voxel[16], const struct brainglobe_metadata *metadata);

#endif
