/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Left and right areas: only one side of the drawn atlas is shown, as view_atlas.sides has them; --hemispheres
 * among the options that a session keeps (viewer/opening/view_words.h). */
#ifndef CONUS_VIEWER_MODEL_HEMISPHERES_H
#define CONUS_VIEWER_MODEL_HEMISPHERES_H

#include "viewer/model/viewer.h"
#include <jansson.h>

enum side { SIDE_BOTH = 0, SIDE_LEFT, SIDE_RIGHT, SIDE_COUNT };
/** "both", "left", "right", for scripts. */
extern const char *const side_names[SIDE_COUNT];

/** The sides that areas have, hidden ones, too: both, one of them, or SIDE_COUNT, none. */
enum side side_known(const struct viewer *viewer);
/** "no right areas", where there is one side at most. */
extern const char *const side_missing[SIDE_COUNT + 1];
/** The side whose areas are shown, if all of the other are hidden; SIDE_COUNT where those of both are. */
enum side side_shown(const struct viewer *viewer);
/** Hides the other side's areas; a side that is to be seen and was hidden whole is shown again. Others stay. */
void side_show(struct viewer *viewer, enum side side);
/** Both, left, right, and both again; says so. */
void side_show_next(struct viewer *viewer);

enum { HEMISPHERES_COUNT = CONUS_HEMISPHERES_MERGED + 1 };
/** The meaning of each, for people. */
extern const char *const hemispheres_meanings[HEMISPHERES_COUNT];

/** The hemispheres that the options ask for; NULL is no options. */
conus_hemispheres hemispheres_of_words(const json_t *words);
/** A copy of them that says this; NULL without memory. */
json_t *hemispheres_put_in_words(const json_t *words, conus_hemispheres how);

#endif
