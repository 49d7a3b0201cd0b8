/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which areas and pathways of an atlas are shown: of the atlas that is drawn, unless another is named. */
#ifndef CONUS_VIEWER_MODEL_SHOWN_H
#define CONUS_VIEWER_MODEL_SHOWN_H

#include <conus/conus.h>

struct view_atlas;
struct viewer;

enum shown { SHOWN_NOT = 0, SHOWN_IN_PART, SHOWN };
enum { SEARCH_SIZE = 64 };

struct shown_objects {
    bool *hidden;    /**< [object_count + 1] */
    uint32_t chosen; /**< The object that was clicked in the list of areas; 0 = none. */
    char search[SEARCH_SIZE];
};

/** As @p atlas is; false without memory. */
bool shown_init(struct shown_objects *out, const conus_atlas *atlas);
void shown_finish(struct shown_objects *shown);

/** Hides or shows an object and all below it in the tree. What is hidden is not selected either. */
void viewer_hide(struct viewer *viewer, uint32_t object, bool hide);
/** Hides all but an object and what is below it. */
void viewer_isolate(struct viewer *viewer, uint32_t object);
void viewer_show_all(struct viewer *viewer);
/** Hides in @p on, one of the viewer's atlases, what @p hidden says, [object_count + 1], which is taken over. */
void viewer_set_hidden(struct viewer *viewer, struct view_atlas *on, bool *hidden);
/** Whether @p object is @p ancestor or below it. */
bool viewer_is_below(const struct viewer *viewer, uint32_t object, uint32_t ancestor);
/** What is shown of an object and all below it. */
enum shown viewer_shown(const struct viewer *viewer, uint32_t object);

#endif
