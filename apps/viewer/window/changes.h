/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The steps that undo goes through: texts of states, one after the other, and where among them the window is. */
#ifndef CONUS_VIEWER_WINDOW_CHANGES_H
#define CONUS_VIEWER_WINDOW_CHANGES_H

#include <stdbool.h>
#include <stddef.h>

enum { CHANGES_LIMIT = 100 };

/** All 0 is one without states. */
struct changes {
    char *states[CHANGES_LIMIT]; /**< [count] */
    size_t count, at;            /**< Where there are any, at < count. */
};

/** Takes @p state over as the newest, unless it is the one that is there now; what was taken back before it is gone.
 * The oldest goes where there are too many. */
void changes_add(struct changes *changes, char *state);
/** Takes @p state over in place of the one that is there now: between both nothing can be taken back. */
void changes_renew(struct changes *changes, char *state);
/** Whether changes_step() finds something there. */
bool changes_reach(const struct changes *changes, int by);
/** Goes back (by -1) or forth (1): the state there, borrowed until the next call; NULL = nothing is there. */
const char *changes_step(struct changes *changes, int by);
void changes_finish(struct changes *changes); /**< It is one without states then. */

#endif
