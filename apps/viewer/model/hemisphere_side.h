/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One side of the drawn atlas only: the other side's areas are hidden, as view_atlas.sides has them. */
#ifndef CONUS_VIEWER_MODEL_HEMISPHERE_SIDE_H
#define CONUS_VIEWER_MODEL_HEMISPHERE_SIDE_H

#include "viewer/model/viewer.h"

enum side { SIDE_BOTH = 0, SIDE_LEFT, SIDE_RIGHT, SIDE_COUNT };
/** "both", "left", "right", for scripts. */
extern const char *const side_names[SIDE_COUNT];

/** Whether some areas are left and some right ones. */
bool side_is_known(const struct viewer *viewer);
/** The side whose areas are shown, if all of the other are hidden; SIDE_COUNT where those of both are. */
enum side side_shown(const struct viewer *viewer);
/** Hides the other side's areas; those of a side that is to be seen and was hidden whole are shown again. Areas without
 * a side stay as they are. */
void side_show(struct viewer *viewer, enum side side);
/** Both, left, right, and both again; says so. */
void side_show_next(struct viewer *viewer);

#endif
