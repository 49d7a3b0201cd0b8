/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A manifest in the making: a job's, as all JSON in it is. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_DRAFT_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_DRAFT_H

#include "base/job/job.h"
#include "conus/manifest.h"

#include <jansson.h>

struct manifest_draft {
    const char *folder; /**< With '/' at its end. */
    const conus_manifest_options *options;
    LIST(const char *) used; /**< Images that an FSL atlas names, from the folder and without ending. */
    json_t *parcellation;    /**< An object; a list of those that are halves. */
    json_t *context, *areas, *pathways, *streamlines;
    json_t *maps;          /**< Areas by probabilities. */
    uint32_t label_offset; /**< Added to the labels of the next group of surfaces. */
    /** Loads a manifest, to try an entry. NULL: every entry is taken, and one that does not load is the reader's error.
     */
    conus_status (*load)(const struct manifest_draft *draft, struct text text);
};

/** Makes the lists. */
void manifest_draft_init(struct job *job, struct manifest_draft *draft);

/** Takes over a new value; NULL, and a failure, where that is NULL. */
json_t *manifest_draft_json(struct job *job, json_t *value);

/** Whether an entry of @p list, an array of objects or NULL, has the file @p name. */
bool manifest_draft_has(const json_t *list, const char *name);

/** Gives a line to options->log. */
__attribute__((format(printf, 3, 4))) void manifest_draft_log(struct job *job, const struct manifest_draft *draft,
                                                              const char *format, ...);

/** Logs that @p name is left out, and @p why it does not load. */
void manifest_draft_leave_out(struct job *job, const struct manifest_draft *draft, const char *name, const char *why);

/** Appends @p entry, a value of the job, to @p list. */
void manifest_draft_append(struct job *job, json_t *list, json_t *entry);

/** Tries whether @p value loads at @p key of a manifest of its own (in a list there, if it is @p listed). NULL if it
 * does, else the reason. */
const char *manifest_draft_try(struct job *job, const struct manifest_draft *draft, const char *key, json_t *value,
                               bool listed);

/** Appends @p value, a new one, to @p list, called @p key, if it loads; logs that @p name, unless NULL, is left out if
 * not. Whether it loads. */
bool manifest_draft_take(struct job *job, const struct manifest_draft *draft, json_t *list, const char *key,
                         json_t *value, const char *name);

/** The manifest as JSON. */
struct text manifest_draft_format(struct job *job, const struct manifest_draft *draft);

#endif
