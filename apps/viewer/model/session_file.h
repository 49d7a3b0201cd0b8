/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reads from a session's file which atlas it belongs to, and finds that atlas again. */
#ifndef CONUS_VIEWER_MODEL_SESSION_FILE_H
#define CONUS_VIEWER_MODEL_SESSION_FILE_H

#include "conus/atlas.h"

#include "base/system/system.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/** A session as it was read. */
struct session_file {
    json_t *root;
    const char *atlas;     /**< As it was given; borrowed from root, as what follows. */
    const char *folder;    /**< "" = unknown. */
    const char *sha256;    /**< "" = unknown. */
    uint64_t bytes;        /**< With sha256. */
    const json_t *options; /**< An array of texts; NULL = unknown. */
};

/** Whether @p path is a session's file; then end @p out with session_file_finish(). A damaged file does not count. */
bool session_file_read(struct session_file *out, const char *path);
void session_file_finish(struct session_file *file);

/** Finds the atlas: where it was, beside the session, and, if its checksum is known, any file beside the session and
 * among @p others that has it. False: it is nowhere there. */
bool session_file_find(char out[SYSTEM_PATH], const struct session_file *file, const char *session,
                       const char *const *others, size_t count);
/** Finds what was beside the atlas @p atlas, a path: the same file, by its checksum, or by name where none is known. */
bool session_file_find_near(char out[SYSTEM_PATH], const struct session_file *file, const char *atlas);
/** Whether the atlas is surely another than that of the session, by its checksum. */
bool session_file_differs(const struct session_file *file, const conus_atlas *atlas);

/** The text of @p key in a JSON object; "" = none. */
const char *json_text(const json_t *object, const char *key);

#endif
