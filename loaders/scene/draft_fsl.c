/* SPDX-License-Identifier: BSD-3-Clause */
/* FSL atlas XMLs in a folder of which a manifest is made: which of several names the volume. */
#include "loaders/scene/draft_fsl.h"

#include "base/memory.h"
#include "loaders/scene/load_parcellation.h"

#include <string.h>

conus_status draft_fsl_mark(struct manifest_draft *draft, const struct fsl_atlas *atlas)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < atlas->image_count; i++) {
        const char *image = atlas->images[i].image;
        const char *summary = atlas->images[i].summary;
        status = image ? names_add(&draft->used, image + strspn(image, "/")) : CONUS_OK;
        status = status || !summary ? status : names_add(&draft->used, summary + strspn(summary, "/"));
    }
    return status;
}

bool draft_fsl_has(const struct manifest_draft *draft, const char *name)
{
    size_t length = volume_stem_length(name);
    for (size_t i = 0; i < draft->used.count; i++) {
        const char *used = draft->used.names[i];
        if (volume_stem_length(used) == length && strncmp(used, name, length) == 0) {
            return true;
        }
    }
    return false;
}

static conus_status choose(const char **name, const struct manifest_draft *draft, const char *xml,
                           const struct parcellation *parts)
{
    const char *volume = parts->file.path + strlen(draft->folder);
    if (draft_fsl_has(draft, volume)) {
        *name = NULL;
        return manifest_draft_log(draft, "%s: left out, since another XML has %s", xml, volume);
    }
    if (!parts->is_disputed) {
        return CONUS_OK;
    }
    *name = volume;
    return manifest_draft_log(draft, "%s: left out for %s, which has other names by itself: %s", xml, volume,
                              parts->notes.lines[parts->notes.count - 1]);
}

conus_status draft_fsl_choose(char **name, const struct manifest_draft *draft, const char *xml)
{
    struct parcellation parts = {0};
    const conus_load_options options = {.max_memory = draft->options->max_memory};
    const char *chosen = xml; /* what does not load says so when it is tried */
    char *path = manifest_draft_path(draft, xml);
    conus_status status = path ? parcellation_read(&parts, path, &options, "an atlas XML") : CONUS_ERROR_MEMORY;
    status = status ? status : choose(&chosen, draft, xml, &parts);
    status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
    *name = status || !chosen ? NULL : memory_text(chosen, strlen(chosen));
    parcellation_finish(&parts);
    memory_free(path);
    return status || !chosen || *name ? status : CONUS_ERROR_MEMORY;
}
