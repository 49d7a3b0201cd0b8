/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A manifest in the making: items are appended, if they load. It is a job's. */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_DRAFT_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_DRAFT_H

#include "conus/own.h"
#include "loaders/manifest/scene.h"

struct manifest_draft {
    const char *folder; /**< With '/' at its end. */
    const conus_manifest_options *options;
    LIST(const char *) used; /**< Images that an FSL atlas names, from the folder and without ending. */
    struct scene scene;
    uint32_t label_offset; /**< Added to the labels of the next group of surfaces. */
    /** Loads a manifest, to try an item. NULL: every item is taken, and one that does not load is the reader's error.
     */
    conus_status (*load)(const struct manifest_draft *draft, struct text text);
};

/** The first item of @p kinds with the file @p name, or NULL. */
const struct scene_item *manifest_draft_find(const struct manifest_draft *draft, unsigned kinds, const char *name);

/** Gives a line to options->log. */
__attribute__((format(printf, 3, 4))) void manifest_draft_log(struct job *job, const struct manifest_draft *draft,
                                                              const char *format, ...);

/** Logs that @p name is left out, and @p why it does not load. */
void manifest_draft_leave_out(struct job *job, const struct manifest_draft *draft, const char *name, const char *why);

/** Tries whether @p items are a manifest of their own. NULL if they are, else the reason. */
const char *manifest_draft_try(struct job *job, const struct manifest_draft *draft, const struct scene_item *items,
                               size_t count);

/** Appends @p item if it loads; logs that @p name, unless NULL, is left out if not. Whether it loads. */
bool manifest_draft_take(struct job *job, struct manifest_draft *draft, const struct scene_item *item,
                         const char *name);

#endif
