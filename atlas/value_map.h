/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The values of a volume of which most voxels hold the same: pathways and maps of probabilities.
 *
 * Voxels are counted as elsewhere, i fastest. Each VALUE_RUN of them in turn are a run, and of a run that holds nothing
 * but the value of voxel 0, the background, only that is kept. Values are kept as codes of as many bytes as the file
 * has, and a table of what they mean, or as floats. */
#ifndef CONUS_ATLAS_VALUE_MAP_H
#define CONUS_ATLAS_VALUE_MAP_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { VALUE_BOUNDS = 8 }; /**< Of value_map_spread(). */
/** Voxels of a run, and runs of a page. */
enum { VALUE_RUN = 64, VALUE_RUNS = 64, VALUE_PAGE = VALUE_RUN * VALUE_RUNS };

struct value_map {
    size_t count;       /**< Voxels; 0: there is no map. */
    size_t page_count;  /**< Pages that are kept, */
    size_t run_count;   /**< and runs; number 0 of both is the background's. */
    size_t table_count; /**< 0: the codes are floats. */
    size_t width;       /**< Bytes of a code: 1, 2 or 4. */
    uint32_t *pages;    /**< [value_map_pages()] Number of the page with these voxels. */
    uint32_t *runs;     /**< [page_count][VALUE_RUNS] Number of the run with these. */
    void *codes;        /**< [run_count][VALUE_RUN] */
    float *table;       /**< [table_count] The value of each code. */
};

/** Writes the codes of @p count voxels from @p stored on. */
typedef void value_coder(void *user, void *codes, const uint8_t *stored, size_t count);

/** Makes a map of @p count voxels, at least one, of @p size bytes each, with codes of @p width bytes that @p code
 * writes: first that of voxel 0, then those of each run to be kept, in order. The map has no table. */
conus_status value_map_init(struct value_map *out, const void *stored, size_t size, size_t count, size_t width,
                            value_coder *code, void *user);

/** The same of floats as they are. */
conus_status value_map_of(struct value_map *out, const float *values, size_t count);

/** Frees the arrays. */
void value_map_finish(struct value_map *map);

/** Copies a map with its arrays. */
conus_status value_map_copy(struct value_map *out, const struct value_map *map);

/** Whether the counts are those of a map of @p count voxels, and its numbers lead to pages and runs. */
bool value_map_is_sound(const struct value_map *map, size_t count);

/** The first voxel from @p voxel on of which a run is kept; map->count if there is none. */
size_t value_map_next(const struct value_map *map, size_t voxel);

/** Divides all values by @p scale, in double; below 0 and above 1 they become these. */
void value_map_divide(struct value_map *map, double scale);

/** Adds to above[i] how many voxels have values above bounds[i]; there are up to VALUE_BOUNDS. */
void value_map_spread(uint64_t *above, const struct value_map *map, const double *bounds, size_t count);

/** Whether no more than one value is there besides 0, as in a mask of whatever value. */
bool value_map_is_mask(const struct value_map *map);

static inline size_t value_map_pages(size_t voxels)
{
    return voxels / VALUE_PAGE + 1;
}

/** The value of code number @p at. */
static inline float value_map_code(const struct value_map *map, size_t at)
{
    if (map->width == sizeof(float)) {
        return ((const float *)map->codes)[at];
    }
    size_t code = map->width == 1 ? ((const uint8_t *)map->codes)[at] : ((const uint16_t *)map->codes)[at];
    return map->table[code < map->table_count ? code : 0]; /* a damaged one is not followed */
}

static inline float value_map_at(const struct value_map *map, size_t voxel)
{
    const uint32_t *page = map->runs + (size_t)map->pages[voxel / VALUE_PAGE] * VALUE_RUNS;
    size_t run = page[voxel / VALUE_RUN % VALUE_RUNS];
    return value_map_code(map, run * VALUE_RUN + voxel % VALUE_RUN);
}

#endif
