/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Sessions of the window as text. */
#ifndef CONUS_TESTS_SUPPORT_SESSION_WORDS_H
#define CONUS_TESTS_SUPPORT_SESSION_WORDS_H

#include "viewer/session/session.h"

#include <jansson.h>

/** The window's session, to be freed. */
static inline char *session_text(const struct window *window)
{
    json_t *root = session_json(window);
    char *text = root ? json_dumps(root, JSON_INDENT(1)) : NULL;
    json_decref(root);
    return text;
}

/** Opens one; false: @p why says why not. */
static inline bool session_parse(struct window *window, const char *text, size_t size, char why[PROPERTY_REASON])
{
    json_error_t error;
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    const bool fine = root ? session_read(window, root, "session", why)
                           : session_refuse(why, "session: line %d: %s", error.line, error.text);
    json_decref(root);
    return fine;
}

#endif
