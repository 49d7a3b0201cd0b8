/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Atlases of BrainGlobe: their metadata, and the folders of the third release. */
#ifndef CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_H
#define CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_H

#include "base/job/job.h"

/* BrainGlobe's metadata.json, and where its arrays lie. Axis 0 of an array is the page of a TIFF stack, axis 1 the
 * row, axis 2 the column. The world's origin is the corner of the grid at which all three axes start. */

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

/* BrainGlobe's folders since its third release: atlases/NAME/1_2/manifest.json says which annotation, names and
 * template an atlas has, and several atlases may share them. Their places count from the folder that holds atlases/,
 * the root. */

/** Texts are the job's. */
struct brainglobe_atlas {
    struct brainglobe_metadata metadata; /**< Complete but for the orientation, which may be empty. */
    bool is_symmetric;                   /**< No file says which side a voxel is on. */
    const char *root;                    /**< The real path of the root, with '/' at its end; NULL until read. */
    const char *name;                    /**< "allen_mouse_25um": the folder of its versions; NULL until read. */
    const char *annotation;              /**< Folders below the root, without '/' at either end. */
    const char *terminology;
    const char *template; /**< NULL where the atlas has none. */
};

/** Whether @p folder, which ends in '/', has such a manifest.json: other programs have files of that name. */
bool brainglobe_atlas_is(struct job *job, const char *folder);

/** Parses @p text. A place that leaves the root, by ".." or otherwise, is CONUS_ERROR_DATA. */
struct brainglobe_atlas brainglobe_atlas_parse(struct job *job, struct text text);

/** Reads manifest.json in @p folder, which ends in '/'. A place from where a link leaves the root is CONUS_ERROR_DATA.
 * Errors carry the path. */
struct brainglobe_atlas brainglobe_atlas_read(struct job *job, const char *folder);

/** The folders of versions in @p folder, "1_2" and the like with a manifest.json, the newest last: 1_10 is newer than
 * 1_9. The job's. */
struct names brainglobe_versions(struct job *job, const char *folder);

#endif
