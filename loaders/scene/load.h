/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The steps behind conus_atlas_load(). Only loaders/load*.c include it. */
#ifndef CONUS_LOADERS_SCENE_LOAD_H
#define CONUS_LOADERS_SCENE_LOAD_H

#include "atlas/atlas.h"
#include "base/buffer.h"
#include "loaders/labels/label_files.h"

/** How far loading is, for who wants to know. */
struct load_progress {
    const conus_load_options *options;
    size_t done, total; /**< Files. */
};

/** Now @p path is read, and with it @p files of the total. */
void load_progress_tell(struct load_progress *progress, const char *path, size_t files);

/** What a parcellation is made of, until atlas_create() has it. */
struct parcellation {
    struct volume_file file;
    uint32_t *labels;
    struct label_table table;
    char *source;          /**< Where the names come from, in words. */
    struct file_sums read; /**< What else than the volume was read. */
    struct notes notes;
};

/** Reads a labelled volume or an FSL atlas XML; @p needed says in words what may stand here. @p out (zeroed) is the
 * caller's to finish, also on failure. */
conus_status parcellation_read(struct parcellation *out, const char *path, const conus_load_options *options,
                               const char *needed);
void parcellation_finish(struct parcellation *parts);

/** An atlas of it; the notes go there. */
conus_status parcellation_atlas(conus_atlas **out, struct parcellation *parts);

/** Adds the chosen volume of @p file as a pathway; threshold 0 and no name are the defaults. On success the atlas has
 * @p notes, those of opening the file, too; on failure it is as before. */
conus_status pathway_add(conus_atlas *atlas, struct volume_file *file, double threshold, const char *wanted,
                         struct notes *notes);

/** Loads what the manifest in @p file, the bytes of @p path, names. A path that ends in '/' is a folder for which the
 * manifest was made up. */
conus_status manifest_load(conus_atlas **out, const char *path, const struct bytes *file,
                           const conus_load_options *options);

/** Appends to @p out a manifest of the surfaces in @p folder (ending in '/'), or of the BrainGlobe atlas that it is. */
conus_status manifest_of_surfaces(struct buffer *out, const char *folder);

/** Loads the surface @p path: its areas are those of the labels of its vertices (options->labels, else in its own
 * file), or there is one, the whole. */
conus_status surface_load(conus_atlas **out, const char *path, const conus_load_options *options);

#endif
