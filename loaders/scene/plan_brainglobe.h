/* SPDX-License-Identifier: BSD-3-Clause */
/** @file An atlas of BrainGlobe's third release as a manifest. */
#ifndef CONUS_LOADERS_SCENE_PLAN_BRAINGLOBE_H
#define CONUS_LOADERS_SCENE_PLAN_BRAINGLOBE_H

#include "base/files/file_sums.h"
#include "base/notes.h"
#include "loaders/manifest/manifest.h"

/** Makes the manifest of the atlas whose manifest.json is in @p folder (with '/' at its end): the annotation's level of
 * its resolution is the parcellation, named by terminology.csv, and the template's the context, if it was downloaded.
 * Names in it count from *root, a folder with '/' at its end, the caller's to memory_free(). manifest.json joins @p
 * read. An annotation that was not downloaded is CONUS_ERROR_IO, whose message says how to do so. */
conus_status plan_brainglobe(struct job *job, struct manifest *out, char **root, const char *folder,
                             struct file_sums *read, struct notes *notes); /* Bridge: the manifest is the job's */

#endif
