/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Atlases that were loaded before, in the folder of base/cache/cache_folder.h: one file NAME.atlas each, which is
 * mapped and never read as a whole. A cache that cannot be read or written is an empty one: nothing here is an error of
 * the load that it serves. docs/architecture.md, "The cache", says when an entry is believed, and why. */
#ifndef CONUS_CACHE_ATLAS_CACHE_H
#define CONUS_CACHE_ATLAS_CACHE_H

#include "atlas/atlas.h"
#include "base/cache/cache_store.h"
#include "base/files/file_trace.h"

#define ATLAS_CACHE_ENDING ".atlas"

/** A load that is kept, if nothing speaks against it. */
struct atlas_cache {
    struct cache_store store;
    struct buffer heard; /**< The notes, as options.log hears them.                    */
    struct file_trace trace;
    conus_load_options options; /**< Those to load with: they keep what is heard.        */
    const conus_load_options *given;
};

/** Begins a load of @p path as something of @p kind; where @p options do not ask for the cache, and where there is
 * none, it does nothing. End it with atlas_cache_finish(). @p options must outlive it. */
void atlas_cache_init(struct atlas_cache *out, const char *path, const char *kind, const conus_load_options *options);
void atlas_cache_finish(struct atlas_cache *cache);

/** The atlas, mapped from its entry, whose notes the options' log has heard again; NULL where there is no entry that
 * may be believed. */
conus_atlas *atlas_cache_find(struct atlas_cache *cache);

/** Begins and ends the part of the load that reads files. */
void atlas_cache_begin_reading(struct atlas_cache *cache);
void atlas_cache_end_reading(struct atlas_cache *cache);

/** Keeps the atlas that was loaded between the two, and maps it in the place of the loaded one. */
void atlas_cache_keep(struct atlas_cache *cache, conus_atlas **atlas);

/** Whether all @p size bytes are the notes of an entry; @p log, unless NULL, hears the notes before the first damaged
 * one. */
bool atlas_cache_tell(const uint8_t *notes, size_t size, conus_log log, void *user);

#endif
