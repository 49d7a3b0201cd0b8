/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A session as JSON (docs/viewer.md): where the cone is and how it looks, what is hidden, where the panes look,
 * thresholds, the context's transfer function, colours. */
#ifndef CONUS_VIEWER_SESSION_SESSION_H
#define CONUS_VIEWER_SESSION_SESSION_H

#include "viewer/session/property.h"
#include "viewer/window/window.h"

#include <jansson.h>

/** The session as JSON; NULL without memory, or where a name is not UTF-8. */
struct json_t *session_json(const struct window *window);
/** Opens what session_json() gave, which may be changed. False: @p why says why in one line, behind @p name and a
 * colon, and nothing changed. */
bool session_read(struct window *window, struct json_t *root, const char *name, char why[PROPERTY_REASON]);

/** False: @p why says why not, in one line. The window knows the path of the session from then on. */
bool session_save(struct window *window, const char *path, char why[PROPERTY_REASON]);
/** Names what was made by hand and is not in the session that was saved or opened last; static; NULL = nothing. */
const char *session_lacks(const struct window *window);
/** Whether the file @p path is JSON; else @p why says why not. */
bool session_check(const char *path, char why[PROPERTY_REASON]);
/** Likewise; the window stays as it was unless the whole file fits. A session of another atlas is refused. */
bool session_load(struct window *window, const char *path, char why[PROPERTY_REASON]);

/* The atlases of a session, read and written: what is hidden and chosen, thresholds, looks, and which one is drawn. */

json_t *session_hidden(const struct view_atlas *view);
json_t *session_thresholds(const struct view_atlas *view);
json_t *session_place(const struct view_atlas *view);
json_t *session_look(const struct view_atlas *view);
/** What the numbers of one of the viewer's atlases mean: [number, label (0 = no area), name] of each object that is
 * hidden, chosen or confirmed, or has a look of its own. */
json_t *session_named(const struct viewer *viewer, size_t atlas);
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

/* A session of an atlas to which other files were added than now: its objects' numbers become those of now. */

/** Changes a session's @p root, of which "opened" says what was added, so that it is of the first atlas of the window
 * as it is opened now. What was of an object that is not there any more is left out; so are grey values and colours of
 * another context. Unchanged where that is not said, of the root or of the window, and without memory. */
void session_fit(json_t *root, const struct window *window);
/** Puts the files that the window's session has, and that were not found, into @p root, which is to be saved in its
 * place, with all that is set for their objects, which get numbers after all others. False without memory. */
bool session_keep_lost(json_t *root, const struct window *window);

/* Files that a user saves: a session where it was before, all else where the dialog was told, which proposes a name
 * by the time: conus-20260131-154500.json. */

/** Asks where, unless it is a session that has a file. */
void save_file(struct window *window, enum saved_file what);
/** Writes window->files.saves to window->files.saves_as, which is NULL then, and says so. A picture is what has just
 * been drawn; the hits of the cone get a sidecar. */
void save_file_as(struct window *window);

/* Takes back and does again what a user has changed: all that a session keeps, but for where the panes look, and for
 * what moves by itself, such as a cone that follows the mouse or a tracker. */

/** Notes the state if it changed. To be called where changes are whole: not while a slider is dragged. */
void undo_note(struct window *window);
/** The state is as it was noted last, though the atlas is not: that is no change to be taken back. */
void undo_renew(struct window *window);
/** Goes a change back (-1) or forth (1), and says so. Where the atlases are to be opened again for it, only once they
 * are (window->files.requested). */
void undo_step(struct window *window, int by);
/** They are: goes there. */
void undo_go_on(struct window *window, int by);

#endif
