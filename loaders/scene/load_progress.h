/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The callbacks of conus_atlas_load(): its progress, and its notes. */
#ifndef CONUS_LOADERS_SCENE_LOAD_PROGRESS_H
#define CONUS_LOADERS_SCENE_LOAD_PROGRESS_H

#include "base/notes.h"
#include "conus/atlas.h"

struct load_progress {
    const conus_load_options *options;
    size_t done, total;    /**< Files. */
    struct note_sink sink; /**< It gives notes to options->log, with the path of the file that is read. */
    char *path;            /**< That path, unless it is the caller's. */
};

/** A load of @p path, as it was asked for, which must outlive it. End it with load_progress_finish(). */
struct load_progress load_progress_of(const char *path, const conus_load_options *options);
void load_progress_finish(struct load_progress *progress);

/** Notes from here on are about the file @p path, which is copied. */
conus_status load_progress_at(struct load_progress *progress, const char *path);

/** The same, and calls options->progress, unless it is NULL: @p path is read now, and with it @p files of the total.
 * Fails where the callback cancels. */
conus_status load_progress_report(struct load_progress *progress, const char *path, size_t files);

#endif
