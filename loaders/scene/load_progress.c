/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls the callbacks of conus_load_options. */
#include "loaders/scene/load_progress.h"

#include "base/memory.h"

#include <string.h>

struct load_progress load_progress_of(const char *path, const conus_load_options *options)
{
    return (struct load_progress){.options = options, .sink = {options->log, options->log_user, path}};
}

void load_progress_finish(struct load_progress *progress)
{
    memory_free(progress->path);
}

conus_status load_progress_at(struct load_progress *progress, const char *path)
{
    char *copy = memory_text(path, strlen(path));
    if (!copy) {
        return CONUS_ERROR_MEMORY;
    }
    memory_free(progress->path);
    progress->sink.path = progress->path = copy;
    return CONUS_OK;
}

conus_status load_progress_report(struct load_progress *progress, const char *path, size_t files)
{
    const conus_load_options *options = progress->options;
    if (options->progress && !options->progress(options->progress_user, path, progress->done, progress->total)) {
        return fail(CONUS_ERROR_CANCELLED, "%s: cancelled before it was read", path);
    }
    progress->done += files;
    return load_progress_at(progress, path);
}
