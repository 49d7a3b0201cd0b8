/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/engine/leap_map.h"

#include "base/memory.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Fine distances are counted up to FINE_LEVELS in PLANES bits; farther away whole bricks are counted. */
enum { PLANES = 4, FINE_LEVELS = (1 << PLANES) - 1, FAR_BRICKS = 32 };

/* Distances are counted in bricks of 8 x 8 x 8, with the margin. */
enum { BRICK = 8, BRICK_WORDS = BRICK, BRICK_LINES = BRICK / LEAP_EDGE };

/* A brick as bits: word k % 8, bit i % 8 + 8 (j % 8). */
struct bits {
    uint64_t word[BRICK_WORDS];
};

/* What making a map needs besides. Bricks here have an empty border of one brick all around, so that every brick has
 * its neighbours. */
struct workshop {
    size_t bricks[3]; /* without that border */
    ptrdiff_t stride[3];
    size_t brick_count;
    struct bits *grown;  /* the occupied voxels, dilated so far */
    struct bits *other;  /* the target of a dilation's steps    */
    struct bits *planes; /* [brick][PLANES] codes, bit by bit   */
    uint8_t *distance;   /* to the nearest occupied brick       */
};

void leap_map_finish(struct leap_map *map)
{
    memory_free(map->block);
    *map = (struct leap_map){0};
}

static void workshop_finish(struct workshop *shop)
{
    memory_free(shop->grown);
    memory_free(shop->other);
    memory_free(shop->planes);
    memory_free(shop->distance);
}

static conus_status workshop_init(struct workshop *shop, const struct leap_map *map)
{
    size_t count = 1;
    *shop = (struct workshop){0};
    for (int a = 0; a < 3; a++) {
        shop->bricks[a] = map->lines[a] / BRICK_LINES;
        shop->stride[a] = (ptrdiff_t)count;
        if (!memory_multiply(count, shop->bricks[a] + 2, &count)) {
            return fail(CONUS_ERROR_MEMORY, "out of memory");
        }
    }
    shop->brick_count = count;
    shop->grown = memory_zeroed(count, sizeof *shop->grown);
    shop->other = memory_zeroed(count, sizeof *shop->other);
    shop->planes = memory_zeroed(count, PLANES * sizeof *shop->planes);
    shop->distance = memory_raw(count, sizeof *shop->distance);
    return shop->grown && shop->other && shop->planes && shop->distance ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static size_t shop_brick(const struct workshop *shop, size_t i, size_t j, size_t k)
{
    return (i + 1) * (size_t)shop->stride[0] + (j + 1) * (size_t)shop->stride[1] + (k + 1) * (size_t)shop->stride[2];
}

/* One bit per object of a run of at most 8 voxels. */
static uint64_t row_bits16(const uint16_t *objects, size_t count)
{
    uint64_t bits = 0;
    if (count == BRICK) {
        uint64_t halves[2];
        memcpy(halves, objects, sizeof halves);
        if (!(halves[0] | halves[1])) {
            return 0;
        }
    }
    for (size_t i = 0; i < count; i++) {
        bits |= (uint64_t)(objects[i] != 0) << i;
    }
    return bits;
}

static uint64_t row_bits32(const uint32_t *objects, size_t count)
{
    uint64_t bits = 0;
    for (size_t i = 0; i < count; i++) {
        bits |= (uint64_t)(objects[i] != 0) << i;
    }
    return bits;
}

/* Marks one row of voxels along i, starting at linear index `voxel`. */
static void mark_row(struct workshop *shop, const struct volume *volume, size_t j, size_t k, size_t voxel)
{
    size_t dim = volume->info.dim[0];
    size_t y = j + LEAP_MARGIN;
    size_t z = k + LEAP_MARGIN;
    struct bits *brick = &shop->grown[shop_brick(shop, 0, y / BRICK, z / BRICK)];
    for (size_t x = 0; x < dim + LEAP_MARGIN; x += BRICK, brick++) { /* voxel i is at x = i + LEAP_MARGIN */
        size_t skipped = x ? 0 : LEAP_MARGIN;
        size_t first = voxel + x + skipped - LEAP_MARGIN;
        size_t count = dim + LEAP_MARGIN - x < BRICK ? dim + LEAP_MARGIN - x - skipped : BRICK - skipped;
        uint64_t bits = volume->objects16 ? row_bits16(volume->objects16 + first, count)
                                          : row_bits32(volume->objects32 + first, count);
        if (bits) {
            brick->word[z % BRICK] |= bits << (skipped + BRICK * (y % BRICK));
        }
    }
}

/* Makes the box hold the voxels of a brick's word. */
static void extend_box(struct leap_map *map, const size_t brick[3], size_t k, uint64_t word)
{
    uint64_t columns = word;
    for (int shift = 32; shift >= BRICK; shift /= 2) {
        columns |= columns >> shift;
    }
    columns &= 0xff;
    const size_t low[3] = {(size_t)__builtin_ctzll(columns), (size_t)__builtin_ctzll(word) / BRICK, k};
    const size_t high[3] = {63 - (size_t)__builtin_clzll(columns), (63 - (size_t)__builtin_clzll(word)) / BRICK, k};
    for (int a = 0; a < 3; a++) {
        double base = (double)(brick[a] * BRICK) - LEAP_MARGIN;
        map->first[a] = fmin(map->first[a], base + (double)low[a]);
        map->last[a] = fmax(map->last[a], base + (double)high[a]);
    }
}

static void find_box(struct leap_map *map, const struct workshop *shop)
{
    for (int a = 0; a < 3; a++) {
        map->first[a] = (double)map->dim[a];
        map->last[a] = -1;
    }
    size_t count = shop->bricks[0] * shop->bricks[1] * shop->bricks[2];
    for (size_t b = 0; b < count; b++) {
        const size_t brick[3] = {b % shop->bricks[0], b / shop->bricks[0] % shop->bricks[1],
                                 b / shop->bricks[0] / shop->bricks[1]};
        const struct bits *bits = &shop->grown[shop_brick(shop, brick[0], brick[1], brick[2])];
        for (size_t k = 0; k < BRICK_WORDS; k++) {
            if (bits->word[k]) {
                extend_box(map, brick, k, bits->word[k]);
            }
        }
    }
}

static void mark_occupied(struct workshop *shop, const struct volume *volume)
{
    for (size_t k = 0; k < volume->info.dim[2]; k++) {
        for (size_t j = 0; j < volume->info.dim[1]; j++) {
            mark_row(shop, volume, j, k, volume->info.dim[0] * (j + volume->info.dim[1] * k));
        }
    }
}

/* Calls step for every row of bricks along i, that is for bricks first .. first + shop->bricks[0] - 1. */
typedef void row_step(struct workshop *shop, size_t first, size_t count);

static void for_rows(struct workshop *shop, row_step *step)
{
    for (size_t k = 0; k < shop->bricks[2]; k++) {
        for (size_t j = 0; j < shop->bricks[1]; j++) {
            step(shop, shop_brick(shop, 0, j, k), shop->bricks[0]);
        }
    }
}

/* Adds 1 to the code of every voxel that the growth has not reached. */
static void count_row(struct workshop *shop, size_t first, size_t count)
{
    for (size_t b = first; b < first + count; b++) {
        for (int w = 0; w < BRICK_WORDS; w++) {
            uint64_t carry = ~shop->grown[b].word[w];
            for (int p = 0; p < PLANES; p++) {
                uint64_t *plane = &shop->planes[b * PLANES + (size_t)p].word[w];
                uint64_t sum = *plane ^ carry;
                carry &= *plane;
                *plane = sum;
            }
        }
    }
}

#define EVERY_ROW(byte) (UINT64_C(0x0101010101010101) * (byte))

static void grow_row_along_i(struct workshop *shop, size_t first, size_t count)
{
    const struct bits *from = shop->grown;
    for (size_t b = first; b < first + count; b++) {
        for (int w = 0; w < BRICK_WORDS; w++) {
            uint64_t x = from[b].word[w];
            uint64_t up = (x << 1 & EVERY_ROW(0xfe)) | (from[b - 1].word[w] >> 7 & EVERY_ROW(0x01));
            uint64_t down = (x >> 1 & EVERY_ROW(0x7f)) | (from[b + 1].word[w] << 7 & EVERY_ROW(0x80));
            shop->other[b].word[w] = x | up | down;
        }
    }
}

static void grow_row_along_j(struct workshop *shop, size_t first, size_t count)
{
    const struct bits *from = shop->other;
    size_t step = (size_t)shop->stride[1];
    for (size_t b = first; b < first + count; b++) {
        for (int w = 0; w < BRICK_WORDS; w++) {
            uint64_t x = from[b].word[w];
            uint64_t up = x << 8 | from[b - step].word[w] >> 56;
            uint64_t down = x >> 8 | from[b + step].word[w] << 56;
            shop->grown[b].word[w] = x | up | down;
        }
    }
}

static void grow_row_along_k(struct workshop *shop, size_t first, size_t count)
{
    const struct bits *from = shop->grown;
    size_t step = (size_t)shop->stride[2];
    for (size_t b = first; b < first + count; b++) {
        uint64_t before = from[b - step].word[BRICK_WORDS - 1];
        for (int w = 0; w < BRICK_WORDS; w++) {
            uint64_t after = w + 1 < BRICK_WORDS ? from[b].word[w + 1] : from[b + step].word[0];
            shop->other[b].word[w] = before | from[b].word[w] | after;
            before = from[b].word[w];
        }
    }
}

static void count_fine_distances(struct workshop *shop)
{
    for_rows(shop, count_row);
    for (int level = 1; level < FINE_LEVELS; level++) {
        for_rows(shop, grow_row_along_i);
        for_rows(shop, grow_row_along_j);
        for_rows(shop, grow_row_along_k);
        struct bits *grown = shop->other;
        shop->other = shop->grown;
        shop->grown = grown;
        for_rows(shop, count_row);
    }
}

static void mark_distance_row(struct workshop *shop, size_t first, size_t count)
{
    for (size_t b = first; b < first + count; b++) {
        uint64_t any = 0;
        for (int w = 0; w < BRICK_WORDS; w++) {
            any |= shop->grown[b].word[w];
        }
        shop->distance[b] = any ? 0 : FAR_BRICKS;
    }
}

/* Lowers a brick's distance to 1 + that of the 13 neighbours before it (sign 1) or behind it (sign -1). */
static void relax_brick(struct workshop *shop, size_t brick, ptrdiff_t sign)
{
    uint8_t best = shop->distance[brick];
    for (int n = 0; n < 13; n++) {
        ptrdiff_t offset = (n % 3 - 1) * shop->stride[0] + (n / 3 % 3 - 1) * shop->stride[1];
        offset -= n < 9 ? shop->stride[2] : 0;
        uint8_t further = (uint8_t)(shop->distance[(ptrdiff_t)brick + sign * offset] + 1);
        best = further < best ? further : best;
    }
    shop->distance[brick] = best;
}

static void relax_row(struct workshop *shop, size_t first, size_t count)
{
    for (size_t b = first; b < first + count; b++) {
        relax_brick(shop, b, 1);
    }
}

static void relax_row_backwards(struct workshop *shop, size_t first, size_t count)
{
    for (size_t b = first + count; b-- > first;) {
        relax_brick(shop, b, -1);
    }
}

static void count_brick_distances(struct workshop *shop)
{
    memset(shop->distance, FAR_BRICKS, shop->brick_count);
    for_rows(shop, mark_distance_row);
    for_rows(shop, relax_row);
    for (size_t k = shop->bricks[2]; k-- > 0;) {
        for (size_t j = shop->bricks[1]; j-- > 0;) {
            relax_row_backwards(shop, shop_brick(shop, 0, j, k), shop->bricks[0]);
        }
    }
}

/* spread[b] has bit n of b in its n-th byte. */
static void make_spread(uint64_t spread[256])
{
    for (unsigned b = 0; b < 256; b++) {
        uint8_t bytes[8];
        for (unsigned n = 0; n < 8; n++) {
            bytes[n] = (uint8_t)(b >> n & 1);
        }
        memcpy(&spread[b], bytes, sizeof bytes);
    }
}

/* Eight codes along i. */
static uint64_t fine_codes(const struct bits planes[PLANES], int row, const uint64_t spread[256])
{
    uint64_t eight = 0;
    for (int p = 0; p < PLANES; p++) {
        eight += spread[planes[p].word[row / BRICK] >> BRICK * (row % BRICK) & 0xff] << p;
    }
    return eight;
}

/* The first line of codes of the brick's half along each axis that a bit of `part` says. */
static uint8_t *line_of(const struct leap_map *map, const size_t brick[3], int part)
{
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = BRICK_LINES * brick[a] + (size_t)(part >> a & 1);
    }
    return map->codes + LEAP_LINE * (at[0] + map->lines[0] * (at[1] + map->lines[1] * at[2]));
}

static void write_fine_codes(const struct leap_map *map, const size_t brick[3], const struct bits planes[PLANES],
                             const uint64_t spread[256])
{
    for (int part = 0; part < 8; part += 2) {
        uint8_t *codes = line_of(map, brick, part);
        for (int at = 0; at < LEAP_LINE; at += LEAP_EDGE) {
            int y = at / LEAP_EDGE % LEAP_EDGE + (part & 2) * 2;
            int z = at / LEAP_EDGE / LEAP_EDGE + (part & 4);
            uint64_t eight = fine_codes(planes, y + BRICK * z, spread);
            uint8_t bytes[BRICK];
            memcpy(bytes, &eight, sizeof bytes);
            memcpy(codes + at, bytes, LEAP_EDGE);
            memcpy(codes + LEAP_LINE + at, bytes + LEAP_EDGE, LEAP_EDGE);
        }
    }
}

/* A voxel of a brick n bricks away from an occupied one has n - 1 whole empty bricks on every side. */
static void write_codes(struct leap_map *map, const struct workshop *shop)
{
    uint64_t spread[256];
    make_spread(spread);
    for (size_t b = 0; b < shop->bricks[0] * shop->bricks[1] * shop->bricks[2]; b++) {
        const size_t brick[3] = {b % shop->bricks[0], b / shop->bricks[0] % shop->bricks[1],
                                 b / shop->bricks[0] / shop->bricks[1]};
        size_t at = shop_brick(shop, brick[0], brick[1], brick[2]);
        int far = 1 + BRICK * (shop->distance[at] - 1);
        for (int part = 0; part < 8 && far > FINE_LEVELS; part++) {
            memset(line_of(map, brick, part), far < UINT8_MAX ? far : UINT8_MAX, LEAP_LINE);
        }
        if (far <= FINE_LEVELS) {
            write_fine_codes(map, brick, shop->planes + at * PLANES, spread);
        }
    }
}

/* ---- Where the codes lie ----------------------------------------------------------------------------------------- */

/* In front of leaps is the map without its pointer, and what keeps the codes in lines of the cache. */
enum { LEAPS_HEAD = 128 };
static_assert(sizeof(struct leap_map) <= LEAPS_HEAD, "the map fits in front of its codes");

/* Everything but the codes; gives the bytes that these need. */
static size_t measure(struct leap_map *map, const struct volume *volume)
{
    *map = (struct leap_map){0};
    for (int a = 0; a < 3; a++) {
        map->dim[a] = volume->info.dim[a];
        map->lines[a] = (map->dim[a] + 2 * (size_t)LEAP_MARGIN + BRICK - 1) / BRICK * BRICK_LINES;
    }
    return leap_map_codes(map); /* not much more than the number of voxels, which was checked */
}

/* Fills the codes and the box of a measured map. */
static conus_status fill(struct leap_map *map, const struct volume *volume)
{
    struct workshop shop;
    conus_status status = workshop_init(&shop, map);
    if (!status) {
        mark_occupied(&shop, volume);
        find_box(map, &shop);
        count_brick_distances(&shop);
        count_fine_distances(&shop);
        write_codes(map, &shop);
    }
    workshop_finish(&shop);
    return status;
}

size_t leap_map_size(const struct volume *volume)
{
    struct leap_map map;
    return LEAPS_HEAD + measure(&map, volume);
}

conus_status leap_map_write(void *memory, const struct volume *volume)
{
    struct leap_map map;
    size_t size = measure(&map, volume);
    if (volume->leaps) {
        memcpy(memory, volume->leaps, LEAPS_HEAD + size);
        return CONUS_OK;
    }
    map.codes = (uint8_t *)memory + LEAPS_HEAD;
    conus_status status = fill(&map, volume);
    map.codes = NULL;
    memset(memory, 0, LEAPS_HEAD);
    memcpy(memory, &map, sizeof map);
    return status;
}

conus_status leap_map_init(struct leap_map *out, const struct volume *volume)
{
    struct leap_map map;
    size_t size = measure(&map, volume);
    if (volume->leaps) {
        memcpy(out, volume->leaps, sizeof *out);
        out->codes = (uint8_t *)volume->leaps + LEAPS_HEAD; /* is only read */
        return CONUS_OK;
    }
    map.block = memory_raw(size / LEAP_LINE + 1, LEAP_LINE);
    map.codes =
        (uint8_t *)(((uintptr_t)map.block + LEAP_LINE - 1) / LEAP_LINE * LEAP_LINE); /* on the processor's lines */
    conus_status status = map.block ? fill(&map, volume) : CONUS_ERROR_MEMORY;
    if (status) {
        leap_map_finish(&map);
        return status;
    }
    *out = map;
    return CONUS_OK;
}
