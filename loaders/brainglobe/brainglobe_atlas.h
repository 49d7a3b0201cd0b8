/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * BrainGlobe's folders since its third release: atlases/NAME/1_2/manifest.json says which annotation, names and
 * template an atlas has, and several atlases may share them. Their places count from the folder that holds atlases/,
 * the root. */
#ifndef CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_ATLAS_H
#define CONUS_LOADERS_BRAINGLOBE_BRAINGLOBE_ATLAS_H

#include "base/files/folder.h"
#include "loaders/brainglobe/brainglobe_metadata.h"

struct brainglobe_atlas {
    struct brainglobe_metadata metadata; /**< Complete but for the orientation, which may be empty. */
    bool is_symmetric;                   /**< No file says which side a voxel is on. */
    char *name;                          /**< "allen_mouse_25um": the folder of its versions; NULL until read. */
    char *annotation;                    /**< Folders below the root, without '/' at either end. */
    char *terminology;
    char *template; /**< NULL where the atlas has none. */
};

/** Whether @p folder, which ends in '/', has such a manifest.json: other programs have files of that name. */
conus_status brainglobe_atlas_is(bool *out, const char *folder);

/** Parses @p text. A place that leaves the root, by ".." or otherwise, is CONUS_ERROR_DATA. */
conus_status brainglobe_atlas_parse(struct brainglobe_atlas *out, struct text text);

/** Reads manifest.json in @p folder, which ends in '/'; it joins @p read. *root gets the real path of the root, with
 * '/' at its end, the caller's to memory_free(). A place from where a link leaves the root is CONUS_ERROR_DATA. Errors
 * carry the path. */
conus_status brainglobe_atlas_read(struct brainglobe_atlas *out, char **root, const char *folder,
                                   struct file_sums *read);
void brainglobe_atlas_finish(struct brainglobe_atlas *atlas);

/** The folders of versions in @p folder, "1_2" and the like with a manifest.json, the newest last: 1_10 is newer than
 * 1_9. @p out is the caller's to finish, also on failure. */
conus_status brainglobe_versions(struct names *out, const char *folder);

#endif
