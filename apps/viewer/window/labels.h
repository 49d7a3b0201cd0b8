/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Places for names in a pane: none lies on another, nor on what is reserved, and each object has one. */
#ifndef CONUS_VIEWER_WINDOW_LABELS_H
#define CONUS_VIEWER_WINDOW_LABELS_H

#include "viewer/ui/ui.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LABELS_LIMIT = 24 };

/** All 0 is a pane without names. */
struct labels {
    struct placed_name {
        struct ui_box box;
        uint32_t object; /**< 0 = it is reserved for something else. */
    } items[LABELS_LIMIT];
    size_t count;
    bool (*allows)(void *user, const struct ui_box *box, uint32_t object); /**< Whether an object's name may lie there,
                                                                               besides; NULL = anywhere. */
    void *user;                                                            /**< Its first argument. */
};

/** No name may lie there. */
void labels_reserve(struct labels *labels, struct ui_box box);
/** Whether nothing lies there. */
bool labels_leave_free(const struct labels *labels, const struct ui_box *box);
bool labels_has(const struct labels *labels, uint32_t object);
/** Finds the place of a name so large in pixels, as near to @p at as it can be: beside it, or first @p above it. False:
 * the object has a name already, or there is no room. */
bool labels_place(struct ui_box *out, struct labels *labels, const struct ui_box *pane, const float at[2],
                  const float size[2], bool above, uint32_t object);

#endif
