/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A load of conus_atlas_load(): its job, the callbacks of its options, and the atlas that it makes. */
#ifndef CONUS_LOADERS_SCENE_LOAD_PROGRESS_H
#define CONUS_LOADERS_SCENE_LOAD_PROGRESS_H

#include "atlas/atlas.h"
#include "base/job/job.h"

struct load {
    struct job job; /**< Its notes and files wait there for atlas_take(). */
    const conus_load_options *options;
    conus_atlas *atlas;    /**< NULL until load_create(). */
    struct note_sink sink; /**< It gives notes to options->log, with the path of the file that is read. */
    char *path;            /**< That path, unless it is the caller's. */
};

/** Begins a load of @p path, as it was asked for, which must outlive it. End it with load_end(). */
void load_begin(struct load *out, const char *path, const conus_load_options *options);

/** Ends the load and gives the atlas away, or destroys it after a failure, or where @p out is NULL. */
conus_status load_end(conus_atlas **out, struct load *load);

/** Notes from here on are about the file @p path, which is copied. */
void load_at(struct load *load, const char *path);

/** The same, and job_report(). */
void load_report(struct load *load, const char *path, size_t files);

/** Makes the atlas of @p count volumes, as atlas_create_of() does, with the notes so far; of none an empty one. */
void load_create(struct load *load, struct labelled_volume *volumes, size_t count, const struct label_table *table,
                 const char *label_source);

/** The name mesh_file_name() of the surface @p path; NULL after a failure. */
char *mesh_name(struct job *job, const char *path);

/** Notes and files of a load that its atlas gets later: */
struct deferred_notes {
    struct notes notes;
    struct file_sums files;
};

/** puts those of the job aside, and then back, in front of those that it has got since. Both calls are made in one
 * function, also after a failure. */
struct deferred_notes load_defer_notes(struct load *load);
void load_release_notes(struct load *load, struct deferred_notes *deferred);

#endif
