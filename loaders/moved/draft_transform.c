/* SPDX-License-Identifier: BSD-3-Clause */
/* Knows a transform by its name's ending and its content. */
#include "loaders/moved/draft_transform.h"

#include "base/folder.h"
#include "base/memory.h"
#include "loaders/transform/transform_file.h"

static bool is_named_so(const char *name)
{
    return path_ends_in(name, ".tfm") || path_ends_in(name, ".mat") || path_ends_in(name, ".lta") ||
           path_ends_in(name, ".xfm");
}

conus_status draft_transform_say(struct manifest_draft *draft, const char *name)
{
    struct file_sums read = {0};
    double matrix[16];
    if (!is_named_so(name)) {
        return CONUS_OK;
    }
    char *path = manifest_draft_path(draft, name);
    conus_status status = path ? transform_file_read(matrix, path, NULL, NULL, &read) : CONUS_ERROR_MEMORY;
    bool is_transform = !status || status == CONUS_ERROR_ARGUMENT; /* FSL's, without its images */
    status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
    if (!status && is_transform) {
        status = manifest_draft_log(draft,
                                    "%s: a transform, left out: where it leads is not known; \"transform\": \"%s\" in "
                                    "the manifest brings the areas to the other images",
                                    name, name);
    }
    file_sums_finish(&read);
    memory_free(path);
    return status;
}
