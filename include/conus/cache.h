/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file cache.h
 * Files that conus keeps in the user's cache folder, $XDG_CACHE_HOME/conus, else ~/.cache/conus: atlases and
 * tractograms, where conus_load_options.cache and conus_streamlines_options.cache ask for it, and surfaces of areas.
 * All of it can be made again.
 *
 * $CONUS_CACHE is "off", and then no atlas is kept or taken from there, or the most that atlases may have together: a
 * number of bytes, or one with K, M, G or T behind it (default 4G). Those unused for longest leave first.
 *
 * An atlas is taken from there only where the folder and the file belong to the user and nobody else may write to them,
 * its checksums hold, it was kept by this build of conus for the same path and options, and every file and folder that
 * was looked at is as it was. A cache that cannot be used is as if it were empty.
 */
#ifndef CONUS_PUBLIC_CACHE_H
#define CONUS_PUBLIC_CACHE_H

#include <conus/status.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_cache conus_cache; /**< A list of what is kept. */

/** Something that is kept. */
typedef struct conus_cache_entry {
    const char *file;  /**< Its name in the folder. */
    const char *kind;  /**< "atlas" or "surfaces". */
    const char *path;  /**< For an atlas: the file that was loaded; bytes, absolute, and without links and dots as far
                          as it is there. "" of surfaces, and where the file does not say. */
    uint64_t size;     /**< Bytes. */
    int64_t last_used; /**< Seconds since 1970. */
} conus_cache_entry;

/**
 * Lists what is kept.
 * @param[out] out The list; end it with conus_cache_destroy().
 * @return #CONUS_OK, also where there is no folder.
 * @threads Any, while none changes the environment.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_cache_create(conus_cache **out);

/**
 * Ends a list.
 * @param cache NULL is allowed.
 * @threads One at a time for each @p cache.
 * @since 0.1
 */
CONUS_API void conus_cache_destroy(conus_cache *cache);

/**
 * Gives the folder.
 * @param cache The list.
 * @return Its path; "" where the environment names none. Borrowed from the list.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const char *conus_cache_folder(const conus_cache *cache);

/**
 * Says why nothing can be kept.
 * @param cache The list.
 * @return A line; NULL where nothing speaks against it. Borrowed from the list.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const char *conus_cache_problem(const conus_cache *cache);

/**
 * Gives how much atlases may have together.
 * @return Bytes; 0 = none are kept, or $CONUS_CACHE says nothing that is allowed.
 * @threads Any, while none changes the environment.
 * @since 0.1
 */
CONUS_API uint64_t conus_cache_limit(void);

/**
 * Counts the entries.
 * @param cache NULL counts 0.
 * @return How many there are.
 * @threads Any.
 * @since 0.1
 */
CONUS_API size_t conus_cache_count(const conus_cache *cache);

/**
 * Gives entry @p index.
 * @param cache The list.
 * @param index From 0: atlases, then surfaces, of each kind the one unused for longest first.
 * @return NULL past the last. Borrowed from the list.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const conus_cache_entry *conus_cache_entry_at(const conus_cache *cache, size_t index);

/**
 * Removes all that is kept. Who uses an atlas from there keeps it.
 * @return #CONUS_OK, also where there is nothing; #CONUS_ERROR_IO where the folder is not the user's alone, or
 * something cannot be removed.
 * @threads Any, while none changes the environment.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_cache_clear(void);

#ifdef __cplusplus
}
#endif

#endif
