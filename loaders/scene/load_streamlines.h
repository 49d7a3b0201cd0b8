/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How tractograms become bundles of an atlas. */
#ifndef CONUS_LOADERS_SCENE_LOAD_STREAMLINES_H
#define CONUS_LOADERS_SCENE_LOAD_STREAMLINES_H

#include "atlas/bundles.h"
#include "conus/streamlines.h"

/** Length of a file's name without ".gz", and without the ending of a tractogram before it. */
size_t streamlines_stem_length(const char *name);

/** The radius that is wanted, mm, for the tractogram @p path. CONUS_ERROR_ARGUMENT. */
conus_status streamlines_radius(double *out, double wanted, const char *path);

/** Adds @p tractogram, checked and with a radius, which is taken over on success, as bundles; the one of all
 * streamlines, or of those in no group, is called @p name, or like the path where that is NULL or "". On success the
 * atlas has @p notes, too; on failure it is as before. */
conus_status streamlines_add(conus_atlas *atlas, struct tractogram *tractogram, const char *name, struct notes *notes);

/** Reads the tractogram @p path, of which @p space is stated, into an atlas that has nothing else, and makes it ready
 * for bundles. With @p maps the points may stay in the file (is_in_file): nobody should read them before
 * tractogram_hold_points(). */
conus_status streamlines_load(conus_atlas **out, const char *path, const conus_load_options *options,
                              conus_file_space space, bool maps);

/** Adds that tractogram, which may be mapped, with a radius, mm, and a name as streamlines_add() does; @p options have
 * the log, too. Ends @p alone. On failure @p atlas is as before. */
conus_status streamlines_take(conus_atlas *atlas, conus_atlas *alone, double radius,
                              const conus_streamlines_options *options);

/** A tractogram loaded by conus_tractogram_load(). */
struct conus_tractogram {
    conus_atlas *alone; /**< As streamlines_load() makes it. */
};

/** Makes an atlas like @p alone, whose arrays it borrows, for streamlines_take(). CONUS_ERROR_MEMORY. */
conus_status streamlines_borrow(conus_atlas **out, const conus_atlas *alone);

#endif
