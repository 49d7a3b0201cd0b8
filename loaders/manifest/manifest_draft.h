/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A manifest in the making. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_DRAFT_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_DRAFT_H

#include "base/buffer.h"
#include "base/files/folder.h"
#include "conus/manifest.h"

#include <jansson.h>

struct manifest_draft {
    const char *folder; /**< With '/' at its end. */
    const conus_manifest_options *options;
    struct names used;    /**< Images that an FSL atlas names, from the folder and without ending. */
    json_t *parcellation; /**< An object; a list of those that are halves. */
    json_t *context, *areas, *pathways, *streamlines;
    json_t *maps;          /**< Areas by probabilities. */
    uint32_t label_offset; /**< Added to the labels of the next group of surfaces. */
    /** Loads a manifest, to try an entry. NULL: every entry is taken, and one that does not load is the reader's error.
     */
    conus_status (*load)(const struct manifest_draft *draft, const struct buffer *text);
};

/** Makes its lists. CONUS_ERROR_MEMORY; then it is to be finished, too. */
conus_status manifest_draft_init(struct manifest_draft *draft);
void manifest_draft_finish(struct manifest_draft *draft);

/** Whether an entry of @p list, an array of objects or NULL, has the file @p name. */
bool manifest_draft_has(const json_t *list, const char *name);

/** Gives a line to options->log. */
__attribute__((format(printf, 2, 3))) conus_status manifest_draft_log(const struct manifest_draft *draft,
                                                                      const char *format, ...);

/** Logs that @p name is left out, and conus_message(): why it does not load. */
conus_status manifest_draft_leave_out(const struct manifest_draft *draft, const char *name);

/** Appends @p entry, which is taken over, to @p list. */
conus_status manifest_draft_append(json_t *list, json_t *entry);

/** Tries whether @p value loads at @p key of a manifest of its own (in a list there, if it is @p listed). */
conus_status manifest_draft_try(bool *loads, const struct manifest_draft *draft, const char *key, json_t *value,
                                bool listed);

/** Appends @p value, which is taken over, to @p list, called @p key, if it loads. */
conus_status manifest_draft_append_loading(bool *loads, const struct manifest_draft *draft, json_t *list,
                                           const char *key, json_t *value);

/** Appends the manifest as JSON. */
conus_status manifest_draft_format(struct buffer *out, const struct manifest_draft *draft);

#endif
