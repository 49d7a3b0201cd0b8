/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A parcellation before it is an atlas: voxels with labels, and their table. */
#ifndef CONUS_LOADERS_SCENE_LOAD_PARCELLATION_H
#define CONUS_LOADERS_SCENE_LOAD_PARCELLATION_H

#include "atlas/labels/label_voxels.h"
#include "atlas/labels/labels.h"
#include "base/job/job.h"
#include "loaders/volumes/volume_file.h"
#include "sources/source.h"

/** All of it is the job's. */
struct parcellation {
    struct volume_file file;
    struct label_voxels labels;
    struct label_table *table;
    struct label_map voxels; /**< Once united: label -> its voxels, before any is taken away. */
    char hemisphere;         /**< The side of areas whose table says none; 0 = unsaid. */
    bool is_disputed;        /**< An atlas XML whose volume by itself has other names, as a note says. */
    bool is_joined;          /**< Voxels of other files are among its own. */
    const char *source;      /**< Where the names come from, in words. */
};

/** Reads the labelled volume, FSL atlas XML or CIFTI file @p path, which @p source has open, into @p out (zeroed); @p
 * needed says in words what may stand here. Files that were read besides the volume are the job's. */
void parcellation_read_opened(struct job *job, struct parcellation *out, const struct source *source, const char *path,
                              const conus_load_options *options, const char *needed);

/** Opens the file @p path and reads it as above. */
void parcellation_read(struct job *job, struct parcellation *out, const char *path, const conus_load_options *options,
                       const char *needed);

/** Fails with CONUS_ERROR_DATA where @p labels, the voxels of @p file, look like an image's grey values, as of
 * grey_judge_file(); a note says so where they are labels @p anyway. */
void parcellation_check_grey(struct job *job, const struct volume_file *file, const struct label_voxels *labels,
                             const struct label_table *table, bool stated, bool anyway);

#endif
