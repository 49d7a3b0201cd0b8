/* SPDX-License-Identifier: BSD-3-Clause */
/* A manifest in the making: entries are appended, if they load, and written as JSON. */
#include "loaders/manifest/manifest_draft.h"

#include "loaders/manifest/manifest.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void end_json(void *value)
{
    json_decref(value);
}

static void refuse_memory(struct job *job)
{
    job_fail(job, CONUS_ERROR_MEMORY, "no memory for the manifest");
}

json_t *manifest_draft_json(struct job *job, json_t *value)
{
    if (!value) {
        refuse_memory(job);
        return NULL;
    }
    job_own(job, end_json, value);
    return job_ok(job) ? value : NULL;
}

void manifest_draft_init(struct job *job, struct manifest_draft *draft)
{
    draft->areas = manifest_draft_json(job, json_array());
    draft->pathways = manifest_draft_json(job, json_array());
    draft->streamlines = manifest_draft_json(job, json_array());
    draft->maps = manifest_draft_json(job, json_array());
}

void manifest_draft_log(struct job *job, const struct manifest_draft *draft, const char *format, ...)
{
    va_list arguments;
    char text[512];
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (job_step(job) && draft->options->log) {
        draft->options->log(draft->options->log_user, &(conus_note){CONUS_SEVERITY_NOTE, draft->folder, text});
    }
}

void manifest_draft_leave_out(struct job *job, const struct manifest_draft *draft, const char *name, const char *why)
{
    manifest_draft_log(job, draft, "%s: left out, since it does not load: %.399s", name, why);
}

void manifest_draft_append(struct job *job, json_t *list, json_t *entry)
{
    if (json_array_append(list, entry)) {
        refuse_memory(job);
    }
}

static struct text write_json(struct job *job, const json_t *root, size_t flags)
{
    size_t size = json_dumpb(root, NULL, 0, flags);
    char *text = job_array(job, &size, 1);
    if (!size || json_dumpb(root, text, size, flags) != size) {
        refuse_memory(job);
    }
    return (struct text){text, size};
}

const char *manifest_draft_try(struct job *job, const struct manifest_draft *draft, const char *key, json_t *value,
                               bool listed)
{
    if (!draft->load) {
        return NULL;
    }
    const char *format = listed ? "{s:i,s:[O]}" : "{s:i,s:O}";
    const json_t *root = manifest_draft_json(job, json_pack(format, "conus_atlas", MANIFEST_VERSION, key, value));
    struct text text = write_json(job, root, 0);
    struct attempt attempt = job_try(job);
    (void)JOB_CALL(job, draft->load(draft, text));
    return attempt_end(job, &attempt, ATTEMPT_TRY);
}

bool manifest_draft_take(struct job *job, const struct manifest_draft *draft, json_t *list, const char *key,
                         json_t *value, const char *name)
{
    json_t *entry = manifest_draft_json(job, value);
    const char *why = manifest_draft_try(job, draft, key, entry, true);
    if (!why) {
        manifest_draft_append(job, list, entry);
    } else if (name) {
        manifest_draft_leave_out(job, draft, name, why);
    }
    return !why;
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

struct text manifest_draft_format(struct job *job, const struct manifest_draft *draft)
{
    bool listed = json_is_array(draft->parcellation);
    const struct {
        const char *key;
        json_t *value;
    } parts[] = {{listed ? "parcellations" : "parcellation", draft->parcellation},
                 {"areas", draft->areas},
                 {"probabilities", draft->maps},
                 {"pathways", draft->pathways},
                 {"streamlines", draft->streamlines},
                 {"context", draft->context}};
    json_t *root = manifest_draft_json(job, json_pack("{s:i}", "conus_atlas", MANIFEST_VERSION));
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        bool empty = json_is_array(parts[i].value) && !json_array_size(parts[i].value);
        if (parts[i].value && !empty && json_object_set(root, parts[i].key, parts[i].value)) {
            refuse_memory(job);
        }
    }
    struct text text = write_json(job, root, JSON_INDENT(2));
    return text_from(job_format(job, "%.*s\n", (int)text.size, text.data ? text.data : ""));
}
