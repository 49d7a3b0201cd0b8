/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Strings that live together and end together: of the rows of a block. */
#ifndef CONUS_POSES_ROWS_POSE_STRINGS_H
#define CONUS_POSES_ROWS_POSE_STRINGS_H

#include "base/text.h"

enum { POSE_STRING_LIMIT = 4096 };

/** All 0 is empty. */
struct pose_strings {
    struct pose_chunk *first, *last;
};

/** A copy of @p text (its first POSE_STRING_LIMIT - 1 bytes); NULL without memory. */
const char *pose_strings_add(struct pose_strings *strings, struct text text);
/** Ends all strings, but keeps the memory for the next ones. */
void pose_strings_clear(struct pose_strings *strings);
void pose_strings_finish(struct pose_strings *strings);

#endif
