/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlases that were opened lately, newest first: conus/recent.json in $XDG_STATE_HOME, else in
 * ~/.local/state: {"conus_recent": 1, "atlases": ["/absolute/path", ...]}. */
#ifndef CONUS_VIEWER_WINDOW_RECENT_H
#define CONUS_VIEWER_WINDOW_RECENT_H

#include "base/system/system.h"

#include <stdbool.h>
#include <stddef.h>

enum { RECENT_LIMIT = 8 };

struct recent {
    char paths[RECENT_LIMIT]
              [SYSTEM_PATH]; /**< Absolute, and shorter than SYSTEM_PATH; whether they are there nobody asks. */
    size_t count;
};

/** Reads what was written, and nothing else; false, and @p out stays as it is, where it is not that. */
bool recent_parse(struct recent *out, const char *text, size_t size);
/** Reads the list into @p out, which is empty where no valid list is stored. */
void recent_load(struct recent *out);
/** Puts an atlas first and writes the file. Nothing happens where its absolute path is too long or no UTF-8. */
void recent_add(const char *path);

#endif
