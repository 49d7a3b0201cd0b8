/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Lines of advice gathered on the way, for whoever reads the result. */
#ifndef CONUS_BASE_NOTES_H
#define CONUS_BASE_NOTES_H

#include "base/status.h"

struct notes {
    char **lines;
    size_t count;
};

void notes_finish(struct notes *notes);

/** Adds one line. CONUS_ERROR_MEMORY when it cannot be kept: a lost warning is a failure. */
conus_status notes_add(struct notes *notes, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Forgets all lines but the first @p count. */
void notes_cut(struct notes *notes, size_t count);

/** Appends the lines of @p from, which is left empty. */
conus_status notes_move(struct notes *notes, struct notes *from);

#endif
