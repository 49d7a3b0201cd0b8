/* SPDX-License-Identifier: BSD-3-Clause */
/* A manifest in the making: items are appended, if they load. */
#include "loaders/manifest/manifest.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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

const char *manifest_draft_try(struct job *job, const struct manifest_draft *draft, const struct scene_item *items,
                               size_t count)
{
    if (!draft->load) {
        return NULL;
    }
    const struct scene scene = {.items = {.at = (struct scene_item *)items, .count = count}};
    struct attempt attempt = job_try(job);
    const struct text text = scene_write(job, &scene);
    (void)JOB_CALL(job, draft->load(draft, text));
    return attempt_end(job, &attempt, ATTEMPT_TRY);
}

bool manifest_draft_take(struct job *job, struct manifest_draft *draft, const struct scene_item *item, const char *name)
{
    const char *why = manifest_draft_try(job, draft, item, 1);
    if (!why) {
        scene_add(job, &draft->scene, item);
    } else if (name) {
        manifest_draft_leave_out(job, draft, name, why);
    }
    return !why;
}

const struct scene_item *manifest_draft_find(const struct manifest_draft *draft, unsigned kinds, const char *name)
{
    const struct scene_item *item = NULL;
    do {
        item = scene_next(&draft->scene, kinds, item);
    } while (item && !(item->file && strcmp(item->file, name) == 0));
    return item;
}
