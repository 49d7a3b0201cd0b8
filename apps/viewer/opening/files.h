/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What files are that shall be opened: an atlas or a session, and what is added to it. */
#ifndef CONUS_VIEWER_OPENING_FILES_H
#define CONUS_VIEWER_OPENING_FILES_H

#include "viewer/opening/loader.h"
#include "viewer/opening/view_settings.h"
#include "viewer/window/window.h"

/** What is to be opened first, and what is to be added to it. Paths are borrowed. */
struct sorted {
    const char *atlas;   /**< Or a session, or an image, which opening it tells; NULL = there is none. */
    bool is_session;     /**< It is a session. */
    const char **images; /**< [image_count] */
    const char **tractograms;
    size_t image_count, tractogram_count;
};

/** Tells the files of @p wanted apart, which are read on another thread. False: nobody wants them any more, or @p why
 * has the reason. @p out is the caller's to files_finish() in any case. */
bool files_sort(struct sorted *out, struct window *window, const struct wanted *wanted,
                const struct view_settings *settings, char why[LOADER_WHY]);
void files_finish(struct sorted *sorted);

/** Whether what is at @p path may be an atlas by itself: it is no session and no tractogram. Reads it. */
bool files_may_be_atlas(const char *path);
/** The options @p words with all that is to be added; NULL without memory, or where a name is not UTF-8. */
json_t *files_add(const json_t *words, const struct sorted *sorted);

#endif
