/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a file is, by its content and else by the ending of its name, for messages that say so. */
#ifndef CONUS_LOADERS_FILE_KIND_H
#define CONUS_LOADERS_FILE_KIND_H

#include "base/files/file.h"

#include <stdbool.h>

enum { FILE_KIND_HEAD = 1 << 16 }; /**< Bytes that file_kind_of() wants to see, if there are as many. */

struct file_kind {
    const char *words; /**< "a TrackVis tractogram".                                    */
    const char *way;   /**< What conus can do with it, or NULL: "give it as --labels".  */
};

/** What @p head, the first bytes of a file, unpacked, is; NULL if that is not known. The ending of @p path decides
 * where the bytes do not; it may be NULL. */
const struct file_kind *file_kind_of(const char *path, const struct bytes *head);

/** The first character of the file @p path that is not white space, in its first 64 bytes; 0 if there is none. */
char file_first_character(const char *path);

/** True of text in a format that conus does not know. */
bool file_kind_is_vague(const struct file_kind *kind);

/** Whether @p bytes, a whole file, are lines (a tractogram) in one of VTK's formats and no surface. */
bool file_kind_is_lines(const struct bytes *bytes);

/** As file_kind_of(), for the whole of a file, packed or not. */
const struct file_kind *file_kind_of_stored(const char *path, const struct bytes *stored);

/** Fails with CONUS_ERROR_DATA and one line without the path: what the file is, what is needed, the way on. */
conus_status file_kind_fail(const char *path, const struct bytes *stored, const char *needed);

/** Likewise for the file @p path, which is read for it, with the path in front. */
conus_status file_kind_refuse(const char *path, const char *needed);

#endif
