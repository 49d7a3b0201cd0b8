/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Results that took long to make, kept for the next time: one file per result, named by the SHA-256 of everything that
 * it follows from, in $XDG_CACHE_HOME/conus (else ~/.cache/conus). A cache that cannot be read or written is an empty
 * one: nothing here is an error of the work that it serves, except a lack of memory. */
#ifndef CONUS_LOADERS_CHILD_MESH_CACHE_H
#define CONUS_LOADERS_CHILD_MESH_CACHE_H

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/notes.h"

enum { MESH_CACHE_KEY_SIZE = 65 };

/** The most that the folder may hold, in bytes; the entries unused for longest leave first. */
#define MESH_CACHE_LIMIT (UINT64_C(1) << 30)

/** The name of an entry that follows from the bytes of @p recipe. */
void mesh_cache_key(char key[MESH_CACHE_KEY_SIZE], const struct buffer *recipe);

/** The content of entry @p key. out->data stays NULL if there is no such entry or it is damaged. A folder or an entry
 * that others own or can write to counts as missing, and @p notes says so. */
conus_status mesh_cache_find(struct bytes *out, const char *key, struct notes *notes);

/** Keeps @p content as entry @p key. Whoever reads meanwhile sees the old content or the new, whole. */
conus_status mesh_cache_keep(const char *key, const struct buffer *content);

/** The same with another limit than MESH_CACHE_LIMIT. */
conus_status mesh_cache_keep_within(const char *key, const struct buffer *content, uint64_t limit);

/** How many of the @p size bytes of an entry are its content; SIZE_MAX if it is not whole. */
size_t mesh_cache_content(const void *entry, size_t size);

#endif
