/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The JSON of `conus info --format json`. */
#ifndef CONUS_CLI_ANSWERS_INFO_JSON_H
#define CONUS_CLI_ANSWERS_INFO_JSON_H

#include "conus/own.h"

#include <jansson.h>
#include <stddef.h>
#include <stdio.h>

/** The atlas as a JSON text with a final newline; NULL without memory. The caller frees it. @p installed: what its name
 * meant; NULL = it was a path. */
char *info_json(const conus_atlas *atlas, const conus_installed *installed);

/** "same", "changed", "not there": by conus_source_state. */
extern const char *const info_source_states[];

/** An installed atlas as a JSON object; NULL without memory. */
json_t *info_json_installed(const conus_installed *atlas);

/** A text of any bytes; what is not UTF-8 is taken as ISO-8859-1, as in the library's reports. NULL without memory. */
json_t *info_json_bytes(const char *bytes);

/** Numbers for people: sets those to 0 that are within 1e-7 of the largest of them, or of @p scale if that is larger.
 * That is rounding, as of files with single precision. */
void info_drop_rounding(double *numbers, size_t count, double scale);

/** Prints the line "reaches" for the box with these corners, mm, without digits that are only rounding. */
void info_put_reach(FILE *out, const double low[3], const double high[3]);

/** A paragraph for people, with an empty line before it; nothing of an atlas that is not moved or has no areas. */
void info_place_put(FILE *out, const conus_atlas *atlas);

/** A paragraph for people about each, with an empty line before it. */
void info_tracts_put(FILE *out, const conus_atlas *atlas);

#endif
