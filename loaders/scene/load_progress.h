/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Progress of conus_atlas_load(). */
#ifndef CONUS_LOADERS_SCENE_LOAD_PROGRESS_H
#define CONUS_LOADERS_SCENE_LOAD_PROGRESS_H

#include "conus/conus.h"

struct load_progress {
    const conus_load_options *options;
    size_t done, total; /**< Files. */
};

/** Calls options->progress, unless it is NULL: @p path is read now, and with it @p files of the total. Fails where the
 * callback cancels. */
conus_status load_progress_report(struct load_progress *progress, const char *path, size_t files);

#endif
