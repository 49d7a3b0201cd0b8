/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * How an entry of the cache is found, believed and written, whatever it holds: the rules are the same for all that is
 * mapped. A cache that cannot be read or written is an empty one: nothing here is an error of the work that it serves.
 * docs/architecture.md, "The cache", says when an entry is believed, and why. */
#ifndef CONUS_BASE_CACHE_CACHE_STORE_H
#define CONUS_BASE_CACHE_CACHE_STORE_H

#include "base/cache/cache_entry.h"

/** The most that the entries of atlases may have together, in bytes, unless $CONUS_CACHE says otherwise. */
#define CACHE_LIMIT (UINT64_C(4) << 30)

/** Bytes that may be kept: $CONUS_CACHE, a number, perhaps with K, M, G or T behind it; "off" is 0. False, and 0, for
 * any other text. */
bool cache_limit(uint64_t *out);

/** The values that $CONUS_CACHE may have, for messages. */
#define CACHE_LIMITS "off, or a number of bytes with K, M, G, T or nothing behind it"

/** CONUS_ERROR_ARGUMENT where it is not. */
conus_status cache_check_limit(void);

/** An entry that may be there. */
struct cache_store {
    struct buffer key;         /**< All that decides the entry, except the files. */
    struct buffer path;        /**< The entry's; empty where there is no cache. */
    const char *ending;        /**< The ending of its name, by its kind. */
    uint64_t limit;            /**< Bytes that all entries of its kind may have. */
    uint64_t small;            /**< CACHE_SMALL */
    struct cache_part written; /**< The trace of an entry that was kept just now: who maps that asks no file again. */
};

/** Begins the key of an entry made from @p path by this build on this machine; with @p relative it has the folder that
 * paths are relative to. False where nothing may be kept. End it with cache_store_finish() in either case. */
bool cache_store_begin(struct cache_store *store, const char *ending, const char *path, bool relative);

/** Appends a string to a key; NULL differs from an empty one. */
void cache_key_append(struct buffer *key, const char *text);

/** Once the key is whole: gives the entry its path. */
void cache_store_name(struct cache_store *store);
void cache_store_finish(struct cache_store *store);

/** Appends the path that cache_store_begin() was given, with the folder that it is relative to, to @p out; nothing
 * where it is no key. */
void cache_key_path(struct buffer *out, const uint8_t *key, size_t size);

/** An entry in memory. */
struct cache_mapping {
    void *memory; /**< NULL = none */
    size_t size;
    struct cache_entry entry; /**< Its parts, in `memory`. */
};

/** Maps the entry if it may be believed: it is the user's alone, its key is that of @p store, its files are as they
 * were, and its checksums hold. What it says beyond that is the caller's to check. */
bool cache_store_map(struct cache_mapping *out, const struct cache_store *store);
void cache_mapping_finish(struct cache_mapping *mapping);

/** Writes the packed part of an entry to @p file, from @p at on. */
typedef bool cache_writer(void *user, int file, size_t at);

/** Writes @p entry, whose notes, trace and packed.size are set; removes other entries of its kind if it needs their
 * space. False where it was not kept. */
bool cache_store_keep(struct cache_store *store, struct cache_entry *entry, cache_writer *write, void *user);

#endif
