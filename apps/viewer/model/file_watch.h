/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Watches the files of an atlas that is shown, which stays as it was read when one changes on disk. */
#ifndef CONUS_VIEWER_MODEL_FILE_WATCH_H
#define CONUS_VIEWER_MODEL_FILE_WATCH_H

#include "conus/atlas.h"

#include <stdbool.h>

enum { FILE_WATCH_TEXT = 160 };

struct file_watch;

/** Notes how the files are now; NULL without memory. The atlas outlives it. */
struct file_watch *file_watch_create(const conus_atlas *atlas);
void file_watch_destroy(struct file_watch *watch);

/** Looks again. True: one changed, went away or came back since the last look, as @p text says in a line. */
bool file_watch_check(struct file_watch *watch, char text[FILE_WATCH_TEXT]);
/** The name of a file that has changed since the watch began, and that @p now was read from, too; NULL = none has. */
const char *file_watch_find_other(const struct file_watch *watch, const conus_atlas *now);

#endif
