/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A session as JSON (docs/viewer.md): where the cone is and how it looks, what is hidden, where the panes look,
 * thresholds, the context's transfer function, colours. */
#ifndef CONUS_VIEWER_SESSION_SESSION_H
#define CONUS_VIEWER_SESSION_SESSION_H

#include "viewer/session/property.h"

/** The session as JSON; NULL without memory, or where a name is not UTF-8. */
struct json_t *session_json(const struct window *window);
/** Opens what session_json() gave, which may be changed. False: @p why says why in one line, behind @p name and a
 * colon, and nothing changed. */
bool session_read(struct window *window, struct json_t *root, const char *name, char why[PROPERTY_REASON]);

/** The session as text, to be freed. */
char *session_text(const struct window *window);
bool session_parse(struct window *window, const char *text, size_t size, char why[PROPERTY_REASON]);

/** False: @p why says why not, in one line. The window knows the path of the session from then on. */
bool session_save(struct window *window, const char *path, char why[PROPERTY_REASON]);
/** Names what was made by hand and is not in the session that was saved or opened last; static; NULL = nothing. */
const char *session_lacks(const struct window *window);
/** Whether the file @p path is JSON; else @p why says why not. */
bool session_check(const char *path, char why[PROPERTY_REASON]);
/** Likewise; the window stays as it was unless the whole file fits. A session of another atlas is refused. */
bool session_load(struct window *window, const char *path, char why[PROPERTY_REASON]);

#endif
