/* SPDX-License-Identifier: BSD-3-Clause */
/* Knows BrainGlobe's folders by the names of their files. */
#include "loaders/manifest/manifest_brainglobe.h"

#include <string.h>

static bool has_file(struct job *job, const char *folder, const char *name)
{
    return job_has_file(job, job_format(job, "%s%s", folder, name));
}

bool brainglobe_has_voxels(struct job *job, const char *folder)
{
    bool annotated = has_file(job, folder, BRAINGLOBE_ANNOTATION);
    return has_file(job, folder, "structures.json") && annotated;
}

const char *brainglobe_of_meshes(struct job *job, const char *path)
{
    static const char name[] = "/meshes";
    size_t tail = strlen(name);
    size_t length = strlen(path);
    while (length && path[length - 1] == '/') {
        length--;
    }
    if (length < tail || strncmp(path + length - tail, name, tail) != 0) {
        return NULL;
    }
    const char *folder = job_format(job, "%.*s/", (int)(length - tail), path);
    return has_file(job, folder, "structures.json") ? folder : NULL;
}

void manifest_brainglobe_set(struct job *job, struct manifest_draft *draft)
{
    draft->parcellation = manifest_draft_json(job, json_pack("{s:s}", "file", BRAINGLOBE_ANNOTATION));
    if (has_file(job, draft->folder, BRAINGLOBE_REFERENCE)) {
        draft->context = manifest_draft_json(job, json_pack("{s:s}", "file", BRAINGLOBE_REFERENCE));
    }
}
