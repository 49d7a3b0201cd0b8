/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What streamlines can be coloured by, as conus render --streamline-colour has it: their bundle, their
 * direction, and the numbers of their files, each name once. */
#ifndef CONUS_VIEWER_PICTURES_TRACT_COLOUR_H
#define CONUS_VIEWER_PICTURES_TRACT_COLOUR_H

#include <conus/conus.h>

enum { TRACT_BY_BUNDLE = 0, TRACT_BY_DIRECTION, TRACT_BY_NUMBER /**< and above */, TRACT_COLOUR_LIMIT = 64 };

/** "bundle", "direction", a number's name, which is the atlas's; NULL past the last, and where there are no
 * streamlines. */
const char *tract_colour_name(const conus_atlas *atlas, size_t colour);
/** The one of that name; TRACT_COLOUR_LIMIT = none. */
size_t tract_colour_find(const conus_atlas *atlas, const char *name);
/** How many there are; 0 where there are no streamlines. */
size_t tract_colour_count(const conus_atlas *atlas);
/** Least and largest finite value of a number, over all files that have it; false where there is none. */
bool tract_colour_range(double out[2], const conus_atlas *atlas, const char *name);

#endif
