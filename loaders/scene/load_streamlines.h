/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How tractograms become bundles of an atlas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_STREAMLINES_H
#define CONUS_LOADERS_SCENE_LOAD_STREAMLINES_H

#include "atlas/bundles.h"
#include "base/job/job.h"
#include "conus/own.h"

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
