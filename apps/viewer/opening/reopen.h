/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Opens a session without its atlas being named: finds that, and the options that it was opened with. */
#ifndef CONUS_VIEWER_REOPEN_H
#define CONUS_VIEWER_REOPEN_H

#include "viewer/model/additions.h"
#include "viewer/model/session_file.h"
#include "viewer/opening/view_words.h"
#include "viewer/window/window.h"

enum { REOPEN_WHY = 512 };

/** What is to be opened. */
struct reopening {
    char path[PATH_MAX]; /**< Of the atlas, or its name. */
    struct session_file file;
    struct worded worded;            /**< Its settings. */
    json_t *words;                   /**< What these are of: the session's, without what is missing. */
    char missing[ADDITIONS_MISSING]; /**< Files that were added then, and are not found now; "" = none. */
};

/** Finds what the session @p session is of; @p atlas: a path that somebody named in place of it, or NULL. @p given are
 * the settings of the command line, whose options come before the session's where they @p count. False: *why says why
 * not, unless the atlas is not found, which *missing tells. @p session must outlive @p out, which is the caller's to
 * reopening_finish() in any case. */
bool reopening_prepare(struct reopening *out, const char *session, const char *atlas, const struct view_settings *given,
                       bool count, bool *missing, char why[REOPEN_WHY]);
/** Whether the window shows that already: the same atlas, opened in the same way. */
bool reopening_is_open(const struct reopening *reopening, const struct window *window);
void reopening_finish(struct reopening *reopening);

#endif
