/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves what a manifest has made so far. */
#include "loaders/scene/manifest_move.h"

#include "base/files/file.h"
#include "base/memory.h"

#include <stdio.h>

static conus_status move_by(conus_atlas *atlas, const struct manifest_transform *transform, const char *manifest,
                            uint64_t max_memory)
{
    enum { FILES = 4 };
    const char *const given[FILES] = {transform->file, transform->from, transform->to, transform->grid};
    char *paths[FILES] = {NULL};
    bool whole = true;
    for (size_t i = 0; i < FILES; i++) {
        paths[i] = given[i] ? file_beside(manifest, given[i]) : NULL;
        whole = whole && (paths[i] || !given[i]);
    }
    const conus_transform_options options = {.from = paths[1],
                                             .to = paths[2],
                                             .grid = paths[3],
                                             .inverse = transform->inverse,
                                             .vectors = transform->vectors,
                                             .max_memory = max_memory};
    conus_status status = whole ? conus_atlas_transform(atlas, paths[0], &options) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < FILES; i++) {
        memory_free(paths[i]);
    }
    return status;
}

conus_status manifest_move(conus_atlas *atlas, const struct manifest *manifest, const char *path, uint64_t max_memory)
{
    conus_status status = CONUS_OK;
    for (size_t i = manifest->transform_count; !status && i > 0; i--) { /* the atlas goes back through the last first */
        char key[48];
        snprintf(key, sizeof key, manifest->single_transform ? "transform" : "transform[%zu]", i - 1);
        status = move_by(atlas, &manifest->transforms[i - 1], path, max_memory);
        status = status ? fail_in(status, key) : CONUS_OK;
    }
    return status;
}
