/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves what a manifest has made so far. */
#include "loaders/moved/manifest_move.h"

#include "base/file.h"
#include "base/memory.h"

#include <stdio.h>

static conus_status move_by(conus_atlas *atlas, const struct manifest_transform *transform, const char *manifest)
{
    char *path = file_beside(manifest, transform->file);
    char *from = transform->from ? file_beside(manifest, transform->from) : NULL;
    char *to = transform->to ? file_beside(manifest, transform->to) : NULL;
    const conus_transform_options options = {.from = from, .to = to, .inverse = transform->inverse};
    bool whole = path && (from || !transform->from) && (to || !transform->to);
    conus_status status = whole ? conus_atlas_transform(atlas, path, &options) : CONUS_ERROR_MEMORY;
    memory_free(path);
    memory_free(from);
    memory_free(to);
    return status;
}

conus_status manifest_move(conus_atlas *atlas, const struct manifest *manifest, const char *path)
{
    conus_status status = CONUS_OK;
    for (size_t i = manifest->transform_count; !status && i > 0; i--) { /* the atlas goes back through the last first */
        char key[48];
        snprintf(key, sizeof key, manifest->single_transform ? "transform" : "transform[%zu]", i - 1);
        status = move_by(atlas, &manifest->transforms[i - 1], path);
        status = status ? fail_in(status, key) : CONUS_OK;
    }
    return status;
}
