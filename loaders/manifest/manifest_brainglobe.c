/* SPDX-License-Identifier: BSD-3-Clause */
/* Knows BrainGlobe's folders by the names of their files. */
#include "loaders/manifest/manifest_brainglobe.h"

#include "base/files/file.h"
#include "base/memory.h"

#include <string.h>

static conus_status has_file(bool *out, const char *folder, const char *name)
{
    char *path = file_beside(folder, name);
    *out = path && file_exists(path);
    memory_free(path);
    return path ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status brainglobe_has_voxels(bool *out, const char *folder)
{
    bool named = false;
    conus_status status = has_file(out, folder, BRAINGLOBE_ANNOTATION);
    status = status ? status : has_file(&named, folder, "structures.json");
    *out = *out && named;
    return status;
}

conus_status brainglobe_of_meshes(char **out, const char *path)
{
    static const char name[] = "meshes";
    size_t length = strlen(path);
    bool named = false;
    *out = NULL;
    while (length && path[length - 1] == '/') {
        length--;
    }
    size_t tail = strlen(name);
    bool meshes = length > tail && path[length - tail - 1] == '/' && strncmp(path + length - tail, name, tail) == 0;
    if (!meshes) {
        return CONUS_OK;
    }
    char *folder = memory_text(path, length - tail);
    conus_status status = folder ? has_file(&named, folder, "structures.json") : CONUS_ERROR_MEMORY;
    if (status || !named) {
        memory_free(folder);
        return status;
    }
    *out = folder;
    return CONUS_OK;
}

conus_status manifest_brainglobe_set(struct manifest_draft *draft)
{
    bool reference = false;
    conus_status status = has_file(&reference, draft->folder, BRAINGLOBE_REFERENCE);
    draft->parcellation = status ? NULL : json_pack("{s:s}", "file", BRAINGLOBE_ANNOTATION);
    draft->context = reference ? json_pack("{s:s}", "file", BRAINGLOBE_REFERENCE) : NULL;
    bool made = draft->parcellation && (draft->context || !reference);
    return status || made ? status : fail(CONUS_ERROR_MEMORY, "no memory for the manifest");
}
