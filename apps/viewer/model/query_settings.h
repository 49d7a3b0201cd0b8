/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Changes the query settings, all at once or one. If the atlas refuses a value, the status line says so and nothing
 * changes. */
#ifndef CONUS_VIEWER_MODEL_QUERY_SETTINGS_H
#define CONUS_VIEWER_MODEL_QUERY_SETTINGS_H

#include "viewer/model/viewer.h"

/** Only what lies between two depths along the axis, mm from the apex, counts; both 0 = everything. */
bool query_set_range(struct viewer *viewer, double nearest, double farthest);
/** Moves the limits by so many mm; where there are none they are 0 and 50 mm first. */
bool query_move_range(struct viewer *viewer, double nearest, double farthest);

/** Rolls areas of the first atlas up; @p level is as --level has it, "" = not at all. False: it was said why not. */
bool query_set_level(struct viewer *viewer, const char *level);
/** The deepest level of the first atlas; 0 where none of its areas is part of another. */
unsigned query_deepest(const struct viewer *viewer);
/** The level as a depth; 0 = there is none, or it is a list of areas. */
unsigned query_depth(const struct viewer *viewer);
/** One level deeper, from none to 1, and from the deepest to none. */
void query_next_level(struct viewer *viewer);

/** Asks as conus query does with the @p words behind the first: --layers, --range, --radius, --level, --score, --order,
 * --resolution, --aperture, --engine, --sampling, --slices, --slice-fraction. What they leave out is the default.
 * False: it was said why not, on stderr, and all stays as it was. */
bool query_set_words(struct viewer *viewer, char **words, int count);

#endif
