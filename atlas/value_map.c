/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes, copies and checks a sparse map of values. */
#include "atlas/volume.h"

#include "base/memory.h"

#include <string.h>

/* A map in the making, and the values that it is made from. */
struct making {
    struct value_map map;
    const uint8_t *stored;
    size_t size;
    uint8_t *background; /* [VALUE_PAGE] voxels like the first */
    value_coder *code;
    void *user;
};

void value_map_finish(struct value_map *map)
{
    memory_free(map->pages);
    memory_free(map->runs);
    memory_free(map->codes);
    memory_free(map->table);
    *map = (struct value_map){0};
}

/* Whether one of `count` voxels from `first` on is not the background. Where the volume ends before, only those that
 * are there count. */
static bool holds_something(const struct making *making, size_t first, size_t count)
{
    size_t left = making->map.count - first;
    count = count < left ? count : left;
    return memcmp(making->stored + first * making->size, making->background, count * making->size) != 0;
}

/* Called for each page that holds something. */
typedef void page_step(struct making *making, size_t first);

static void for_pages(struct making *making, page_step *step)
{
    for (size_t first = 0; first < making->map.count; first += VALUE_PAGE) {
        if (holds_something(making, first, VALUE_PAGE)) {
            step(making, first);
        }
    }
}

static void count_page(struct making *making, size_t first)
{
    making->map.page_count++;
    for (size_t at = first; at < first + VALUE_PAGE && at < making->map.count; at += VALUE_RUN) {
        making->map.run_count += holds_something(making, at, VALUE_RUN);
    }
}

/* Codes of the background where the volume has ended. */
static void fill_page(struct making *making, size_t first)
{
    struct value_map *map = &making->map;
    uint32_t *page = map->runs + map->page_count * VALUE_RUNS;
    map->pages[first / VALUE_PAGE] = (uint32_t)map->page_count++;
    for (size_t at = first; at < first + VALUE_PAGE && at < map->count; at += VALUE_RUN) {
        if (holds_something(making, at, VALUE_RUN)) {
            uint8_t *codes = (uint8_t *)map->codes + map->run_count * VALUE_RUN * map->width;
            size_t left = map->count - at;
            memcpy(codes, map->codes, VALUE_RUN * map->width);
            making->code(making->user, codes, making->stored + at * making->size, left < VALUE_RUN ? left : VALUE_RUN);
            page[(at - first) / VALUE_RUN] = (uint32_t)map->run_count++;
        }
    }
}

static void fill(struct making *making)
{
    struct value_map *map = &making->map;
    making->code(making->user, map->codes, making->stored, 1);
    for (size_t i = 1; i < VALUE_RUN; i++) {
        memcpy((uint8_t *)map->codes + i * map->width, map->codes, map->width);
    }
    map->page_count = map->run_count = 1;
    for_pages(making, fill_page);
}

conus_status value_map_init(struct value_map *out, const void *stored, size_t size, size_t count, size_t width,
                            value_coder *code, void *user)
{
    struct making making = {.map = {.count = count, .width = width, .page_count = 1, .run_count = 1},
                            .stored = stored,
                            .size = size,
                            .background = memory_raw(VALUE_PAGE, size),
                            .code = code,
                            .user = user};
    struct value_map *map = &making.map;
    if (count / VALUE_RUN >= UINT32_MAX || !making.background) {
        memory_free(making.background);
        return fail(CONUS_ERROR_MEMORY, "out of memory");
    }
    for (size_t i = 0; i < VALUE_PAGE; i++) {
        memcpy(making.background + i * size, stored, size);
    }
    for_pages(&making, count_page);
    map->pages = memory_zeroed(value_map_pages(count), sizeof *map->pages);
    map->runs = memory_zeroed(map->page_count, VALUE_RUNS * sizeof *map->runs);
    map->codes = memory_raw(map->run_count, VALUE_RUN * width);
    bool is_made = map->pages && map->runs && map->codes;
    if (is_made) {
        fill(&making);
        *out = *map;
    } else {
        value_map_finish(map);
    }
    memory_free(making.background);
    return is_made ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static void copy_floats(void *user, void *codes, const uint8_t *stored, size_t count)
{
    (void)user;
    memcpy(codes, stored, count * sizeof(float));
}

conus_status value_map_of(struct value_map *out, const float *values, size_t count)
{
    return value_map_init(out, values, sizeof *values, count, sizeof *values, copy_floats, NULL);
}

conus_status value_map_copy(struct value_map *out, const struct value_map *map)
{
    struct value_map copy = *map;
    copy.pages = memory_copy(map->pages, value_map_pages(map->count), sizeof *map->pages);
    copy.runs = memory_copy(map->runs, map->page_count, VALUE_RUNS * sizeof *map->runs);
    copy.codes = memory_copy(map->codes, map->run_count, VALUE_RUN * map->width);
    copy.table = map->table ? memory_copy(map->table, map->table_count, sizeof *map->table) : NULL;
    bool whole = copy.pages && copy.runs && copy.codes && (!map->table || copy.table);
    conus_status status = whole ? CONUS_OK : CONUS_ERROR_MEMORY;
    return GIVE(status, out, copy, value_map_finish(&copy));
}

static bool are_below(const uint32_t *numbers, size_t count, size_t limit)
{
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++) {
        most = numbers[i] > most ? numbers[i] : most;
    }
    return most < limit;
}

bool value_map_is_sound(const struct value_map *map, size_t count)
{
    bool has_table = map->table && map->table_count && (map->width == 1 || map->width == 2);
    return map->count == count && (has_table || (!map->table && map->width == sizeof(float))) && map->pages &&
           map->runs && map->codes && map->page_count && map->run_count &&
           are_below(map->pages, value_map_pages(count), map->page_count) &&
           are_below(map->runs, map->page_count * VALUE_RUNS, map->run_count);
}

size_t value_map_next(const struct value_map *map, size_t voxel)
{
    while (voxel < map->count) {
        uint32_t page = map->pages[voxel / VALUE_PAGE];
        if (!page) {
            voxel += VALUE_PAGE - voxel % VALUE_PAGE;
        } else if (!map->runs[page * (size_t)VALUE_RUNS + voxel / VALUE_RUN % VALUE_RUNS]) {
            voxel += VALUE_RUN - voxel % VALUE_RUN;
        } else {
            return voxel;
        }
    }
    return map->count;
}

void value_map_divide(struct value_map *map, double scale)
{
    float *values = map->table ? map->table : map->codes;
    size_t count = map->table ? map->table_count : map->run_count * VALUE_RUN;
    for (size_t i = 0; i < count; i++) {
        double value = (double)values[i] / scale;
        values[i] = (float)(value < 0 ? 0 : value > 1 ? 1 : value);
    }
}

void value_map_spread(uint64_t *above, const struct value_map *map, const double *bounds, size_t count)
{
    size_t kept = map->count ? (map->run_count - 1) * VALUE_RUN : 0; /* run 0 is the background's, of all others */
    for (size_t i = 0; map->count && i < kept + 1; i++) {
        double value = (double)value_map_code(map, i < kept ? i + VALUE_RUN : 0);
        for (size_t b = 0; b < count; b++) {
            /* The last run may be filled up with the background: fewer are counted for it, modulo 2^64. */
            above[b] += value > bounds[b] ? (i < kept ? 1 : (uint64_t)map->count - kept) : 0;
        }
    }
}

bool value_map_is_mask(const struct value_map *map)
{
    float other = 0;
    for (size_t i = 0; i < map->run_count * VALUE_RUN; i++) { /* each is there, the background at voxel 0 */
        float value = value_map_code(map, i);
        other = other == 0 ? value : other;
        if (value != 0 && value != other) {
            return false;
        }
    }
    return true;
}
