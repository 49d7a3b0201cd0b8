/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The user's folder for what can be made again: $XDG_CACHE_HOME/conus, else ~/.cache/conus. What others can write to,
 * or own, is as if it were not there. The time of use of an entry says which one leaves first. */
#ifndef CONUS_BASE_CACHE_FOLDER_H
#define CONUS_BASE_CACHE_FOLDER_H

#include "base/buffer.h"

/** The folder's path; "" in a buffer without data where the environment names none. */
conus_status cache_folder_path(struct buffer *out);

/** Opens the folder @p path; -1 if there is none. One that is not the user's alone is not opened, and @p theirs set. */
int cache_folder_open(const char *path, bool *theirs);

/** Makes the folders above the file @p path, for the user only; the text is as before on return. */
bool cache_folder_make(char *path);

/** A file of the cache. */
struct cache_item {
    char name[96];
    int64_t used_s, used_ns; /**< Last use, since 1970. */
    uint64_t size;
};

struct cache_listing {
    struct cache_item *items; /**< Owned; the one unused for longest first. */
    size_t count, capacity;
    uint64_t size; /**< Bytes of all entries. */
};

/** Lists the entries of the folder @p path whose names end in @p ending. CONUS_ERROR_MEMORY only. */
conus_status cache_folder_list(struct cache_listing *out, const char *path, const char *ending);
void cache_listing_finish(struct cache_listing *listing);

/** Removes entries, the one unused for longest first, until those that are left have at most @p limit bytes. Whoever
 * has one open or mapped keeps it. */
conus_status cache_folder_fit(const char *path, const char *ending, uint64_t limit);

#endif
