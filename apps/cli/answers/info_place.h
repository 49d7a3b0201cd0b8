/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where a moved atlas lies, as `conus info` shows it. */
#ifndef CONUS_CLI_ANSWERS_INFO_PLACE_H
#define CONUS_CLI_ANSWERS_INFO_PLACE_H

#include <conus/conus.h>

#include <jansson.h>
#include <stddef.h>
#include <stdio.h>

/** Numbers for people: sets those to 0 that are within 1e-7 of the largest of them, or of @p scale if that is larger.
 * That is rounding, as of files with single precision. */
void info_drop_rounding(double *numbers, size_t count, double scale);

/** The line "reaches" of what has these corners, mm, without what is rounding. */
void info_put_reach(FILE *out, const double low[3], const double high[3]);

/** A paragraph for people, with an empty line before it; nothing of an atlas that is not moved or has no areas. */
void info_place_put(FILE *out, const conus_atlas *atlas);

/** The same as a JSON object; JSON's null where there is nothing to say. NULL without memory. */
json_t *info_place_json(const conus_atlas *atlas);

#endif
