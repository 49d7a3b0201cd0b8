/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The files of an atlas, while it is shown: what is in memory stays, but who looks at it shall know that the
 * file is another one now. */
#ifndef CONUS_VIEWER_MODEL_WATCH_H
#define CONUS_VIEWER_MODEL_WATCH_H

#include <conus/conus.h>

enum { WATCH_NEWS = 160 };

struct watch;

/** Notes how the files are now; NULL without memory. Ended by watch_destroy(), which accepts NULL. */
struct watch *watch_create(const conus_atlas *atlas);
void watch_destroy(struct watch *watch);
/** Looks again. True: one changed, went away or came back since the last look, as @p news says in a line. */
bool watch_look(struct watch *watch, char news[WATCH_NEWS]);
/** The name of a file that @p now has, too, and that is another one than when the watch began; NULL = there is none. */
const char *watch_other(const struct watch *watch, const conus_atlas *now);

#endif
