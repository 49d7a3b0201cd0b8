/* SPDX-License-Identifier: BSD-3-Clause */
/** @file An atlas from files: the whole, its parcellation, and its streamlines. */
#ifndef CONUS_LOADERS_SCENE_SCENE_H
#define CONUS_LOADERS_SCENE_SCENE_H

#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "base/job/job.h"
#include "conus/own.h"
#include "loaders/manifest/manifest.h"
#include "loaders/volumes/volumes.h"
#include "sources/source.h"

/* Any file or folder as an atlas. */

/** conus_atlas_load() of a path without template; @p options is not NULL, and of this version. */
conus_status atlas_load_files(conus_atlas **out, const char *path, const conus_load_options *options);

/** Adds what @p item describes of the file @p path, and paths that it has, which are from here, to @p atlas, which is
 * unchanged on failure. Of @p options the log and max_memory count. */
conus_status scene_add_item(conus_atlas *atlas, const char *path, const struct scene_item *item,
                            const conus_load_options *options);

/* A parcellation before it is an atlas: voxels with labels, and their table. */

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

/* How tractograms become bundles of an atlas. */

/** The radius that is wanted, mm, for the tractogram @p path. CONUS_ERROR_ARGUMENT. */
double streamlines_radius(struct job *job, double wanted, const char *path);

/** Adds @p tractogram, checked and with a radius, which is taken over on success, as bundles; the one of all
 * streamlines, or of those in no group, is called @p name, or like the path where that is NULL or "". The atlas has
 * @p notes then, about the file, and those of the job. */
void streamlines_add(struct job *job, conus_atlas *atlas, struct tractogram *tractogram, const char *name,
                     struct notes *notes);

/** Reads the tractogram @p path, of which @p space is stated, into an atlas that has nothing else, and makes it ready
 * for bundles. The atlas is the job's, until job_give(); NULL after a failure. */
conus_atlas *streamlines_load(struct job *job, const char *path, conus_file_space space);

/** Adds the tractogram of @p alone, which is emptied, with a radius, mm, and a name as
 * streamlines_add() does. */
void streamlines_take(struct job *job, conus_atlas *atlas, conus_atlas *alone, double radius, const char *name);

/** A tractogram loaded by conus_tractogram_load(). */
struct conus_tractogram {
    conus_atlas *alone; /**< As streamlines_load() makes it. */
};

/** Makes an atlas like @p alone, whose arrays it borrows, for streamlines_take(). It is the job's; NULL after a
 * failure. */
conus_atlas *streamlines_borrow(struct job *job, const conus_atlas *alone);

#endif
