/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlases of a session, read and written: what is hidden and chosen, thresholds, looks, and which one is
 * drawn. */
#ifndef CONUS_VIEWER_SESSION_SESSION_ATLASES_H
#define CONUS_VIEWER_SESSION_SESSION_ATLASES_H

#include "viewer/session/property.h"

#include <jansson.h>

json_t *session_hidden(const struct view_atlas *view);
json_t *session_thresholds(const struct view_atlas *view);
json_t *session_place(const struct view_atlas *view);
json_t *session_look(const struct view_atlas *view);
/** The entries of all atlases but the first; NULL without memory, or where a path is not UTF-8. */
json_t *session_further(const struct viewer *viewer);

struct session_atlases {
    struct session_atlas {
        bool *hidden;           /**< [object_count + 1]; NULL = it and what is chosen are as they are. */
        uint32_t chosen;        /**< 0 = nothing. */
        struct appearance look; /**< Of no objects = as it is. */
    } * atlases;                /**< [count] */
    double **thresholds;        /**< [count][object_count + 1] Likewise. */
    size_t count;               /**< Number of the viewer's atlases. */
    size_t drawn;               /**< Index of the one to be drawn. */
};

/** Reads them; false where they do not fit the viewer's atlases. The caller's to finish in any case. */
bool session_atlases_read(struct session_atlases *out, const struct viewer *viewer, const json_t *root,
                          char why[PROPERTY_REASON]);
/** Hides and chooses what they say, and makes the atlases look so. */
void session_atlases_show(struct session_atlases *from, struct viewer *viewer);
void session_atlases_finish(struct session_atlases *from);

#endif
