/* SPDX-License-Identifier: BSD-3-Clause */
/* A manifest in the making: entries are appended, if they load, and written as JSON. */
#include "loaders/manifest/manifest_draft.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "loaders/manifest/manifest.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

conus_status manifest_draft_init(struct manifest_draft *draft)
{
    draft->areas = json_array();
    draft->pathways = json_array();
    draft->streamlines = json_array();
    draft->maps = json_array();
    return draft->areas && draft->pathways && draft->streamlines && draft->maps ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void manifest_draft_finish(struct manifest_draft *draft)
{
    names_finish(&draft->used);
    json_decref(draft->parcellation);
    json_decref(draft->context);
    json_decref(draft->areas);
    json_decref(draft->pathways);
    json_decref(draft->streamlines);
    json_decref(draft->maps);
}

conus_status manifest_draft_log(const struct manifest_draft *draft, const char *format, ...)
{
    va_list arguments;
    char text[512];
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (draft->options->log) {
        draft->options->log(draft->options->log_user, &(conus_note){CONUS_SEVERITY_NOTE, draft->folder, text});
    }
    return CONUS_OK;
}

conus_status manifest_draft_append(json_t *list, json_t *entry)
{
    return json_array_append_new(list, entry) ? fail(CONUS_ERROR_MEMORY, "no memory for the manifest") : CONUS_OK;
}

static int put_text(const char *text, size_t size, void *user)
{
    buffer_append(user, text, size);
    return ((struct buffer *)user)->failed ? -1 : 0;
}

conus_status manifest_draft_try(bool *loads, const struct manifest_draft *draft, const char *key, json_t *value,
                                bool listed)
{
    *loads = true;
    if (!draft->load) {
        return CONUS_OK;
    }
    struct buffer text = {0};
    json_t *piece = listed ? json_pack("[O]", value) : json_incref(value);
    json_t *root = json_pack("{s:i,s:o}", "conus_atlas", MANIFEST_VERSION, key, piece);
    bool done = root && json_dump_callback(root, put_text, &text, 0) == 0;
    conus_status status = done ? draft->load(draft, &text) : CONUS_ERROR_MEMORY;
    buffer_finish(&text);
    json_decref(root);
    *loads = status == CONUS_OK;
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

conus_status manifest_draft_leave_out(const struct manifest_draft *draft, const char *name)
{
    char why[400];
    snprintf(why, sizeof why, "%s", conus_message());
    return manifest_draft_log(draft, "%s: left out, since it does not load: %s", name, why);
}

conus_status manifest_draft_append_loading(bool *loads, const struct manifest_draft *draft, json_t *list,
                                           const char *key, json_t *value)
{
    conus_status status = value ? manifest_draft_try(loads, draft, key, value, true) : CONUS_ERROR_MEMORY;
    if (status || !*loads) {
        json_decref(value);
        return status;
    }
    return manifest_draft_append(list, value);
}

bool manifest_draft_has(const json_t *list, const char *name)
{
    bool has = false;
    for (size_t i = 0; i < json_array_size(list) && !has; i++) {
        const char *file = json_string_value(json_object_get(json_array_get(list, i), "file"));
        has = file && strcmp(file, name) == 0;
    }
    return has;
}

/* Sets `key` unless there is nothing to set. */
static bool set_key(json_t *root, const char *key, json_t *value)
{
    bool empty = !value || (json_is_array(value) && !json_array_size(value));
    return empty || json_object_set(root, key, value) == 0;
}

conus_status manifest_draft_format(struct buffer *out, const struct manifest_draft *draft)
{
    json_t *root = json_pack("{s:i}", "conus_atlas", MANIFEST_VERSION);
    const char *parcellation = json_is_array(draft->parcellation) ? "parcellations" : "parcellation";
    bool done = root && set_key(root, parcellation, draft->parcellation) && set_key(root, "areas", draft->areas) &&
                set_key(root, "probabilities", draft->maps) && set_key(root, "pathways", draft->pathways) &&
                set_key(root, "streamlines", draft->streamlines) && set_key(root, "context", draft->context) &&
                json_dump_callback(root, put_text, out, JSON_INDENT(2)) == 0;
    json_decref(root);
    buffer_text(out, "\n");
    return done ? buffer_status(out) : fail(CONUS_ERROR_MEMORY, "no memory for the manifest");
}
