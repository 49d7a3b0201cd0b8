/* SPDX-License-Identifier: BSD-3-Clause */
/* A .dlabel.nii and its surfaces are loaded as the manifest that they make. */
#include "loaders/scene/load_cifti.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "loaders/scene/load_manifest.h"
#include "loaders/scene/plan_cifti.h"

static conus_status plan_file(struct manifest *out, char **path, const char *text, struct load_progress *progress,
                              struct notes *notes)
{
    struct cifti_file file = {0};
    uint64_t max_memory = progress->options->max_memory;
    conus_status status = cifti_file_open(&file, text, max_memory, notes);
    status = status ? status : plan_cifti(out, &file, max_memory, notes);
    if (!status) {
        *path = file.path;
        file.path = NULL;
    }
    cifti_file_finish(&file);
    return status;
}

conus_status cifti_load(conus_atlas **out, const char *path, struct load_progress *progress)
{
    struct manifest manifest = {0};
    struct notes notes = {.sink = &progress->sink};
    conus_atlas *atlas = NULL;
    char *file = NULL;
    if (progress->options->labels) {
        return fail(CONUS_ERROR_ARGUMENT, "--labels %s: %s names its labels itself", progress->options->labels, path);
    }
    conus_status status = plan_file(&manifest, &file, path, progress, &notes);
    status = status ? status : manifest_load_made(&atlas, &manifest, file, "the label table in it", progress);
    status = status ? status : notes_move(&atlas->notes, &notes);
    notes_finish(&notes);
    manifest_finish(&manifest);
    memory_free(file);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    *out = atlas;
    return CONUS_OK;
}
