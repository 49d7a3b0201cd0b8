/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A parcellation before it is an atlas: voxels with labels, and their table. */
#ifndef CONUS_LOADERS_SCENE_LOAD_PARCELLATION_H
#define CONUS_LOADERS_SCENE_LOAD_PARCELLATION_H

#include "atlas/atlas.h"
#include "loaders/probe.h"
#include "loaders/volumes/volume_file.h"

/** The parts of a parcellation, until atlas_create() has them. */
struct parcellation {
    struct volume_file file;
    struct label_voxels labels;
    struct label_table table;
    char hemisphere;       /**< The side of areas whose table says none; 0 = unsaid. */
    bool is_disputed;      /**< An atlas XML whose volume by itself has other names, as a note says. */
    bool is_joined;        /**< Voxels of other files are among its own. */
    char *source;          /**< Where the names come from, in words. */
    struct file_sums read; /**< The files that were read besides the volume. */
    struct notes notes;
};

/** Reads the labelled volume, FSL atlas XML or CIFTI file @p path, which @p probe has open; @p needed says in words
 * what may stand here. @p out (zeroed) is the caller's to finish, also on failure. */
conus_status parcellation_read_opened(struct parcellation *out, const struct probe *probe, const char *path,
                                      const conus_load_options *options, const char *needed);

/** Opens the file @p path and reads it as above. */
conus_status parcellation_read(struct parcellation *out, const char *path, const conus_load_options *options,
                               const char *needed);
void parcellation_finish(struct parcellation *parts);

/** Fails with CONUS_ERROR_DATA where @p labels, the voxels of @p file, look like an image's grey values, as of
 * grey_judge_file(); a note says so where they are labels @p anyway. */
conus_status parcellation_check_grey(const struct volume_file *file, const struct label_voxels *labels,
                                     const struct label_table *table, bool stated, bool anyway, struct notes *notes);

/** An atlas of it; the notes go there. */
conus_status parcellation_atlas(conus_atlas **out, struct parcellation *parts);

#endif
