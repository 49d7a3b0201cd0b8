/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A row of labels as a volume in test_in(), and its names in conus. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_LABEL_ROW_H
#define CONUS_TESTS_SUPPORT_BUILDERS_LABEL_ROW_H

#include <stddef.h>
#include <stdint.h>

/** Writes @p text as the file @p path. */
void row_text(const char *path, const char *text);

/** A row of @p count voxels of @p edge mm, that of world x mm holding label x; the world of i = 0 is x = 0. */
void row_write(const char *name, size_t count, int edge);

/** Loads v.nii; area @p label must be called @p name, the names must come from @p source, and a note have @p note
 * (NULL: no note speaks of names). */
void assert_row(const char *name, uint32_t label, const char *source, const char *note);

/** The same of the volume @p file. */
void assert_row_of(const char *file, const char *name, uint32_t label, const char *source, const char *note);

#endif
