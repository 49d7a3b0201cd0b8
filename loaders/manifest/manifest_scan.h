/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The likely role of each file of a folder in a scene: guesses for a first manifest. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_SCAN_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_SCAN_H

#include "base/files/folder.h"
#include "base/job/job.h"

enum volume_use { VOLUME_LABELS, VOLUME_PATHWAY, VOLUME_SERIES, VOLUME_CONTEXT };

struct volume_guess {
    enum volume_use use;
    size_t count;      /**< Volumes in the file.              */
    const char *words; /**< The reason of the guess; static. */
};

/** Reads the volume @p path and guesses its role. Several volumes are pathways. Values that grey_judge_file() takes for
 * labels are labels, if a table names them or several values lie in pieces. Of other volumes those that are mostly zero
 * are pathways, all others the context. All values 0 are CONUS_ERROR_DATA. */
void volume_guess_make(struct job *job, struct volume_guess *out, const char *path);

/** Whether the names of volumes @p left and @p right differ only in the word for their side: x_LH.nii.gz and
 * x_RH.nii.gz, lh.x.mgz and rh.x.mgz. */
bool volume_names_are_halves(struct job *job, const char *left, const char *right);

/** Whether labels follow from the names of surfaces: each holds a number, and no two the same first one; or none does.
 */
bool surface_names_give_labels(const struct names *names);

#endif
