/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_roi_load(): a volume becomes a region of interest. */
#include "loaders/maps/load_roi.h"

#include "base/memory.h"
#include "base/options.h"
#include "loaders/volumes/volume_values.h"

conus_status roi_of_volume(conus_roi **out, struct volume_file *file, double threshold, struct notes *notes)
{
    float *values = NULL;
    file->info.role = CONUS_ROLE_SCALAR;
    conus_status status = volume_file_values_or_nan(&values, file, notes);
    file->info.threshold = threshold;
    status = status ? status : roi_create(out, &file->info, values);
    if (status) {
        memory_free(values);
    }
    return status;
}

conus_status conus_roi_load(conus_roi **out, const char *path, const conus_roi_options *options)
{
    struct volume_file file = {0};
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_roi_load: a result and a path are needed");
    }
    options = options_of(conus_roi_options, options);
    const struct note_sink sink = {options->log, options->log_user, path};
    struct notes notes = {.sink = &sink};
    conus_status status = volume_file_open_cached(&file, path, options->max_memory, options->cache, &notes);
    status = status ? status : roi_of_volume(out, &file, options->threshold, &notes);
    notes_finish(&notes);
    volume_file_finish(&file);
    return status;
}
