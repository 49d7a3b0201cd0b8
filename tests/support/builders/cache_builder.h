/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A small atlas with a label table, and its entry in a cache of this test. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_CACHE_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_CACHE_BUILDER_H

#include "cache/atlas_cache.h"

enum { CACHED_VOXELS = 27 };

/** Writes an atlas of 3 x 3 x 3 voxels, of which the last has label @p label, beside a label table: its path, absolute
 * (static buffers, four in turn). */
const char *cached_atlas(const char *name, int label);

/** Loads @p path and keeps it as if its files had not changed for an hour; NULL if loading fails. The atlas is mapped
 * only if it was kept. */
conus_atlas *load_and_keep_rested(const char *path, const conus_load_options *options);

/** The atlas that is found for @p path in the cache; NULL = none. @p small is the limit above which an entry is
 * large. */
conus_atlas *find_in_cache(const char *path, const conus_load_options *options, uint64_t small);

/** Whether an atlas is found. */
bool is_in_cache(const char *path);

/** Path of its entry: a static buffer. */
const char *entry_of(const char *path);

/** The packed bytes of an atlas, to compare two of them byte by byte. End it with bytes_finish(). */
struct bytes packed_bytes(const conus_atlas *atlas);

/** Fails unless the cached atlas is the one that the files hold. */
void assert_cached_is_loaded(const char *path);

#endif
