/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Opening the atlases that are open with other options. */
#ifndef CONUS_VIEWER_OPENING_PARTS_H
#define CONUS_VIEWER_OPENING_PARTS_H

#include "viewer/model/viewer.h"
#include "viewer/opening/opening.h"
#include "viewer/window/window.h"

#include <jansson.h>

/* Opens the atlases that are open again with other options: other hemispheres, files added or taken out. */

/** Opens the same atlases with the options @p words in place of their own; undo goes @p step (0 = not at all). @p
 * settings are those of conus-view. All that the user set stays (replace.c). False: the window stays as it was; @p why
 * and stderr say why, unless the user cancelled. True: @p why says what is different now. */
bool reopen(struct window *window, const json_t *words, int step, const struct view_settings *settings,
            char why[LOADER_WHY]);

/* Replaces the viewer's atlases by the same ones, opened with other options, and keeps the user's changes of their
 * objects. Areas are matched by label and name: a half or a pair by those of the area that it was made of. Pathways
 * and bundles are known by their names. */

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
