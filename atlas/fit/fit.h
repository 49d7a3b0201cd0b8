/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether a moved atlas lies in the head of its context, and whether it would in another way. */
#ifndef CONUS_ATLAS_FIT_FIT_H
#define CONUS_ATLAS_FIT_FIT_H

#include "atlas/fit/area_points.h"
#include "atlas/fit/head.h"

/** The fractions of the points in the context's grid and in its head, 0 to 1. */
struct fit {
    double in_grid, in_head;
};

/** The fit of points that @p move moves. There is at least one point. */
struct fit fit_of(const struct head *head, const struct area_points *points, const double move[16]);

/** Adds a warning to the notes of an atlas that was moved and gets a context of these @p values (borrowed, one per
 * voxel): if another reading of its transform brings it into the head clearly better, or if less than half of it is in
 * the head and no other reading is better. CONUS_ERROR_MEMORY. */
conus_status fit_note(conus_atlas *atlas, const conus_volume_info *info, float *values);

/** The same for the surfaces around the areas, of which the last has just been added: the inside of closed ones is the
 * head. Nothing if none is closed, if there is one hemisphere only, or beside a context volume, which shows more. */
conus_status fit_note_surfaces(conus_atlas *atlas);

#endif
