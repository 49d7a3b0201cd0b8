/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The entries of a folder, and paths made of others. */
#ifndef CONUS_BASE_FOLDER_H
#define CONUS_BASE_FOLDER_H

#include "base/path.h"
#include "base/status.h"

/** File names, owned. */
struct names {
    char **names;
    size_t count;
};

enum { NAMES_LIMIT = 4096 }; /**< Names of a folder that names_list() gives. */

/** The first NAMES_LIMIT names in @p folder that end in @p ending, sorted, so that an answer does not depend on the
 * file system; none if there is no such folder. @p ending may be a list, as for path_ending_length(). @p out is the
 * caller's to finish, also on failure. */
conus_status names_list(struct names *out, const char *folder, const char *ending);
void names_finish(struct names *names);

/** Appends a copy of @p name. */
conus_status names_add(struct names *names, const char *name);

/** The folder of @p path with a '/' at its end, "./" if it has none. NULL without memory; memory_free() it. */
char *path_folder(const char *path);

#endif
