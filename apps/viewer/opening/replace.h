/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Replaces the viewer's atlases by the same ones, opened with other options, and keeps the user's changes of
 * their objects. Areas are matched by label and name: a half or a pair by those of the area that it was made of.
 * Pathways and bundles are known by their names. */
#ifndef CONUS_VIEWER_OPENING_REPLACE_H
#define CONUS_VIEWER_OPENING_REPLACE_H

#include "viewer/model/viewer.h"

/** Atlases that take the place of a viewer's. */
struct replacement {
    conus_atlas **atlases;         /**< [atlas_count of the viewer] */
    conus_hemispheres before, how; /**< The viewer's, and theirs. */
    const bool
        *fresh; /**< [object_count + 1] Pathways of the first one whose threshold was asked for anew; NULL = none */
};

/** Puts @p now in place of the viewer's atlases, and takes them over. Cone and views stay. Pathways keep their
 * thresholds, objects are hidden and opaque as they were: both halves as the whole, a whole or a pair only where both
 * halves agree, else it is shown and as opaque as the rest. What was set for grey values stays with their context.
 * False with a reason in @p why: all is as it was, and they are the caller's. */
bool viewer_replace(struct viewer *viewer, const struct replacement *now, char *why, size_t size);

#endif
