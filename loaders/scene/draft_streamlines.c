/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the tractograms of a folder into a manifest. */
#include "loaders/scene/draft_streamlines.h"

#include "base/memory.h"
#include "loaders/scene/draft_transform.h"
#include "loaders/scene/load_streamlines.h"
#include "loaders/tracts/tract_file.h"

#include <string.h>

/* Whether an entry of the list has a name of these characters. */
static bool has_name(const json_t *list, const char *name, size_t length)
{
    bool has = false;
    for (size_t i = 0; i < json_array_size(list) && !has; i++) {
        const char *other = json_string_value(json_object_get(json_array_get(list, i), "name"));
        has = other && strlen(other) == length && strncmp(other, name, length) == 0;
    }
    return has;
}

conus_status draft_streamlines_take(struct manifest_draft *draft, const char *name)
{
    bool loads = false;
    char *path = manifest_draft_path(draft, name);
    if (!path) {
        return CONUS_ERROR_MEMORY;
    }
    bool is_tract = name[0] != '.' && tract_file_is(path);
    memory_free(path);
    if (!is_tract) {
        return draft_transform_say(draft, name);
    }
    size_t length = streamlines_stem_length(name);
    bool taken = has_name(draft->streamlines, name, length) || has_name(draft->pathways, name, length);
    conus_status status = manifest_draft_append_loading(
        &loads, draft, draft->streamlines, "streamlines",
        json_pack("{s:s,s:s#}", "file", name, "name", name, taken ? strlen(name) : length));
    return status  ? status
           : loads ? manifest_draft_log(draft, "%s: streamlines", name)
                   : manifest_draft_leave_out(draft, name);
}
