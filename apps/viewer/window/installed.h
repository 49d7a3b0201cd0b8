/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlases that are installed on this computer, as a list that can be searched. */
#ifndef CONUS_VIEWER_WINDOW_INSTALLED_H
#define CONUS_VIEWER_WINDOW_INSTALLED_H

#include <conus/conus.h>

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

/** Whether each word of @p text is in the atlas's name, or is its source's name or the beginning of that. Upper and
 * lower case are the same, and so are '-', '_', '.', '+' and spaces. An empty text fits all. */
bool installed_fits(const conus_installed *atlas, const char *text);
/** Whether the files @p a and @p b are one atlas in two places: of one name and of as many bytes. */
bool installed_is_same_file(const char *a, const char *b);
/** Whether one before atlas @p index is the same in another place: lists leave it out. */
bool installed_is_twin(const conus_catalogue *catalogue, size_t index);
/** Index of the atlas that a text without a path means: the one of that name, else the first that fits; the number of
 * atlases where none does. */
size_t installed_best(const conus_catalogue *catalogue, const char *text);
/** The next one that fits and is no twin, from @p index on up (1) or down (-1) the list; @p index where there is none.
 */
size_t installed_next(const conus_catalogue *catalogue, const char *text, size_t index, int by);
/** What stands for the atlas where an atlas is opened: its name, "source:name", or where both mean others its path,
 * which is shorter than PATH_MAX; false where it is not. */
bool installed_words(char out[PATH_MAX], const conus_catalogue *catalogue, const conus_installed *atlas);

#endif
