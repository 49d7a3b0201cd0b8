/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls the progress callback of conus_load_options. */
#include "loaders/scene/load_progress.h"

#include "base/status.h"

conus_status load_progress_report(struct load_progress *progress, const char *path, size_t files)
{
    const conus_load_options *options = progress->options;
    if (options->progress && !options->progress(options->progress_user, path, progress->done, progress->total)) {
        return fail(CONUS_ERROR_CANCELLED, "%s: cancelled before it was read", path);
    }
    progress->done += files;
    return CONUS_OK;
}
