/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The words of a line of a script (script.h). */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_WORDS_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_WORDS_H

#include <stdbool.h>
#include <stddef.h>

enum { SCRIPT_WORDS = 9 /**< A command and its arguments. */ };

/** Cuts @p line into words, its pieces, by spaces; "in quotes" is one, # begins a comment. False: too many. */
bool script_split(char *words[SCRIPT_WORDS], size_t *count, char *line);
/** A finite number, and nothing else. */
bool script_number(double *out, const char *word);

#endif
