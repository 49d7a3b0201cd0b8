/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * BrainGlobe's folders since its third release: atlases/NAME/1_2/manifest.json says which annotation, names and
 * template an atlas has, and several atlases may share them. Their places count from the folder that holds atlases/,
 * the root. */
#ifndef CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_ATLAS_H
#define CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_ATLAS_H

#include "loaders/brainglobe/brainglobe_metadata.h"

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
