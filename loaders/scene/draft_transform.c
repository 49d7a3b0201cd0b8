/* SPDX-License-Identifier: BSD-3-Clause */
/* Knows a transform by its name's ending and its content. */
#include "loaders/scene/draft_transform.h"

#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/transform/field_file.h"
#include "loaders/transform/transform_file.h"

static bool is_named_so(const char *name)
{
    return path_ends_in(name, ".tfm") || path_ends_in(name, ".mat") || path_ends_in(name, ".lta") ||
           path_ends_in(name, ".xfm");
}

static conus_status say(struct manifest_draft *draft, const char *name, const char *what)
{
    return manifest_draft_log(draft,
                              "%s: %s, left out: where it leads is not known; \"transform\": \"%s\" in the manifest "
                              "brings the areas to the other images",
                              name, what, name);
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
        status = say(draft, name, "a transform");
    }
    file_sums_finish(&read);
    memory_free(path);
    return status;
}

conus_status draft_field_say(bool *is_field, struct manifest_draft *draft, const char *name)
{
    bool usable = false;
    const char *words = NULL;
    char *path = manifest_draft_path(draft, name);
    conus_status status = path ? field_file_words(&words, &usable, path) : CONUS_ERROR_MEMORY;
    memory_free(path);
    status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK; /* whoever reads the volume says what is wrong */
    *is_field = !status && words;
    if (!status && words) {
        status = usable ? say(draft, name, words)
                        : manifest_draft_log(draft, "%s: %s, left out: it moves no areas", name, words);
    }
    return status;
}
