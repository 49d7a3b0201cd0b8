/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The values of options: numbers, choices, lists. */
#ifndef CONUS_OPTIONS_OPTION_VALUES_H
#define CONUS_OPTIONS_OPTION_VALUES_H

#include "options/options.h"

/** Choice @p index of an option, NULL past the last. */
const char *option_choice(const struct option *option, size_t index);

/** Reads @p text into the option's field at @p field. Prints an error and returns false when it is not what is allowed.
 */
bool option_read(const struct option *option, void *field, const char *text);

/** The whole of @p text as a finite decimal number, whatever the locale; no hexadecimal, no spaces. */
bool number_parse(const char *text, double *out);
/** The whole of @p text as a decimal whole number up to @p limit. */
bool count_parse(const char *text, uint64_t limit, uint64_t *out);

/** Of an @p option that is FILE and keys behind commas, cut off from the end: whether one of @p keys (",radius=", the
 * last NULL) is left in @p file, since its value has a comma, as in radius=0,5. Prints an error then. */
bool key_left_in_file(const char *option, const char *file, const char *const *keys);

#endif
