/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the distance map: it dilates the occupied voxels as bits, and counts farther distances in bricks. */
#include "selection/engine/voxels/distance_map.h"

#include "base/memory.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Fine distances are counted up to FINE_LEVELS in PLANES bits; farther away whole bricks are counted. */
enum { PLANES = 4, FINE_LEVELS = (1 << PLANES) - 1, FAR_BRICKS = 32 };

/* Distances are counted in bricks of 8 x 8 x 8, with the margin. */
enum { BRICK = 8, BRICK_WORDS = BRICK, BRICK_LINES = BRICK / DISTANCE_EDGE };

/* A brick as bits: word k % 8, bit i % 8 + 8 (j % 8). */
struct bits {
    uint64_t word[BRICK_WORDS];
};

/* The input of the codes lies in their own memory until they are written: a layer of bricks along k has the bytes
 * of its codes, BRICK times as many as a bit a voxel takes, and PLANES + 2 of them are needed. */
struct scratch {
    struct bits *layers;
    size_t bricks[3];
    size_t grown, other;  /* roles of a layer's parts */
    struct bits *nothing; /* [bricks[0]]: an empty row, outside the grid */
    uint8_t *distance;    /* to the nearest occupied brick, with a border of one brick all around, so that every ... */
    ptrdiff_t stride[3];  /* ... brick has its neighbours */
    size_t (*growing)[3]; /* [growing_count] the bricks that a step of the growth may change */
    size_t growing_count;
    uint8_t *beside; /* [1 + voxels along i + 1] */
};

/* Parts of a layer, of one bit a voxel each; the codes' planes come first. */
enum {
    PART_GROWN = PLANES /* the occupied voxels, dilated so far */,
    PART_OTHER /* the target of a dilation's steps */
};
static_assert((int)PART_OTHER < (int)BRICK, "the parts of a layer fit where its codes will be");

void distance_map_finish(struct distance_map *map)
{
    memory_free(map->block);
    *map = (struct distance_map){0};
}

static conus_status scratch_init(struct scratch *scratch, const struct distance_map *map)
{
    size_t count = 1;
    *scratch = (struct scratch){.layers = (void *)map->codes, .grown = PART_GROWN, .other = PART_OTHER};
    for (int a = 0; a < 3; a++) {
        scratch->bricks[a] = map->lines[a] / BRICK_LINES;
        scratch->stride[a] = (ptrdiff_t)count;
        if (!memory_multiply(count, scratch->bricks[a] + 2, &count)) {
            return fail(CONUS_ERROR_MEMORY, "out of memory");
        }
    }
    scratch->nothing = memory_zeroed(scratch->bricks[0], sizeof *scratch->nothing);
    scratch->growing = memory_raw(count, sizeof *scratch->growing);
    scratch->distance = memory_raw(count, sizeof *scratch->distance);
    scratch->beside = memory_zeroed(map->dim[0] + 2, sizeof *scratch->beside);
    if (!scratch->nothing || !scratch->growing || !scratch->distance || !scratch->beside) {
        return CONUS_ERROR_MEMORY;
    }
    memset(scratch->distance, FAR_BRICKS, count);
    memset(map->codes, 0, distance_map_codes(map));
    return CONUS_OK;
}

/* The row of bricks (0 .. bricks[0] - 1, j, k) of a layer's part, which for the planes has PLANES bricks for each. */
static struct bits *row_of(const struct scratch *scratch, size_t part, size_t j, size_t k)
{
    size_t layer = scratch->bricks[0] * scratch->bricks[1];
    size_t width = part ? scratch->bricks[0] : PLANES * scratch->bricks[0];
    return scratch->layers + (k * BRICK + part) * layer + j * width;
}

/* A row of the scratch; empty outside the grid. */
static const struct bits *row_or_nothing(const struct scratch *scratch, size_t part, size_t j, size_t k)
{
    bool inside = j < scratch->bricks[1] && k < scratch->bricks[2];
    return inside ? row_of(scratch, part, j, k) : scratch->nothing;
}

static uint8_t *distance_of(const struct scratch *scratch, size_t j, size_t k)
{
    return scratch->distance + scratch->stride[0] + (ptrdiff_t)(j + 1) * scratch->stride[1] +
           (ptrdiff_t)(k + 1) * scratch->stride[2];
}

/* A voxel of a brick n bricks away from an occupied one has n - 1 whole empty bricks on every side. */
static int far_of(int distance)
{
    return 1 + BRICK * (distance - 1);
}

/* Whether each of four numbers is not 0, as bits: the highest bit of each says so, and a product moves it there. */
static uint64_t four_bits(uint64_t four)
{
    const uint64_t low = UINT64_C(0x7fff7fff7fff7fff);
    uint64_t set = ((((four & low) + low) | four) & ~low) >> 15;
    return set * ((UINT64_C(1) << 48) + (UINT64_C(1) << 33) + (1U << 18) + (1U << 3)) >> 48 & 0xf;
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
        return four_bits(halves[0]) | four_bits(halves[1]) << 4;
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

static void mark_occupied(struct scratch *scratch, const struct volume *volume, size_t j, size_t k, size_t voxel)
{
    size_t dim = volume->info.dim[0];
    size_t y = j + DISTANCE_MARGIN;
    size_t z = k + DISTANCE_MARGIN;
    struct bits *brick = row_of(scratch, scratch->grown, y / BRICK, z / BRICK);
    for (size_t x = 0; x < dim + DISTANCE_MARGIN; x += BRICK, brick++) { /* voxel i is at x = i + DISTANCE_MARGIN */
        size_t skipped = x ? 0 : DISTANCE_MARGIN;
        size_t first = voxel + x + skipped - DISTANCE_MARGIN;
        size_t count = dim + DISTANCE_MARGIN - x < BRICK ? dim + DISTANCE_MARGIN - x - skipped : BRICK - skipped;
        uint64_t bits = volume->objects16 ? row_bits16(volume->objects16 + first, count)
                                          : row_bits32(volume->objects32 + first, count);
        if (bits) {
            brick->word[z % BRICK] |= bits << (skipped + BRICK * (y % BRICK));
        }
    }
}

/* Makes the box hold the voxels of a brick's word. */
static void extend_box(struct distance_map *map, const size_t brick[3], size_t k, uint64_t word)
{
    uint64_t columns = word;
    for (int shift = 32; shift >= BRICK; shift /= 2) {
        columns |= columns >> shift;
    }
    columns &= 0xff;
    const size_t low[3] = {(size_t)__builtin_ctzll(columns), (size_t)__builtin_ctzll(word) / BRICK, k};
    const size_t high[3] = {63 - (size_t)__builtin_clzll(columns), (63 - (size_t)__builtin_clzll(word)) / BRICK, k};
    for (int a = 0; a < 3; a++) {
        double base = (double)(brick[a] * BRICK) - DISTANCE_MARGIN;
        map->first[a] = fmin(map->first[a], base + (double)low[a]);
        map->last[a] = fmax(map->last[a], base + (double)high[a]);
    }
}

static void find_box(struct distance_map *map, const struct scratch *scratch)
{
    for (int a = 0; a < 3; a++) {
        map->first[a] = (double)map->dim[a];
        map->last[a] = -1;
    }
    size_t count = scratch->bricks[0] * scratch->bricks[1] * scratch->bricks[2];
    for (size_t b = 0; b < count; b++) {
        const size_t brick[3] = {b % scratch->bricks[0], b / scratch->bricks[0] % scratch->bricks[1],
                                 b / scratch->bricks[0] / scratch->bricks[1]};
        const struct bits *bits = row_of(scratch, scratch->grown, brick[1], brick[2]) + brick[0];
        for (size_t k = 0; k < BRICK_WORDS; k++) {
            if (bits->word[k]) {
                extend_box(map, brick, k, bits->word[k]);
            }
        }
    }
}

/* Marks what is looked for in one row of voxels along i, which starts at linear index `voxel`. */
typedef void row_mark(struct scratch *scratch, const struct volume *volume, size_t j, size_t k, size_t voxel);

/* Calls step for every row of bricks along i. */
typedef void row_step(struct scratch *scratch, size_t j, size_t k);

static void for_rows(struct scratch *scratch, row_step *step)
{
    for (size_t k = 0; k < scratch->bricks[2]; k++) {
        for (size_t j = 0; j < scratch->bricks[1]; j++) {
            step(scratch, j, k);
        }
    }
}

static bool is_full(const struct bits *bits)
{
    uint64_t all = UINT64_MAX;
    for (int w = 0; w < BRICK_WORDS; w++) {
        all &= bits->word[w];
    }
    return all == UINT64_MAX;
}

/* Lists the bricks that the growth of a level may change: others are full, in both of the growth's parts, or too far
 * away. Those that it reaches for the first time have been out of reach in all levels before. */
static void list_growing(struct scratch *scratch, int level)
{
    size_t count = scratch->bricks[0] * scratch->bricks[1] * scratch->bricks[2];
    scratch->growing_count = 0;
    for (size_t n = 0; n < count; n++) {
        const size_t at[3] = {n % scratch->bricks[0], n / scratch->bricks[0] % scratch->bricks[1],
                              n / scratch->bricks[0] / scratch->bricks[1]};
        int first = far_of(distance_of(scratch, at[1], at[2])[at[0]]);
        if (first > level) {
            continue;
        }
        struct bits *planes = row_of(scratch, 0, at[1], at[2]) + at[0] * PLANES;
        for (int p = 0; p < PLANES && first == level; p++) {
            memset(&planes[p], (level - 1) >> p & 1 ? UINT8_MAX : 0, sizeof planes[p]);
        }
        const struct bits *grown = row_of(scratch, scratch->grown, at[1], at[2]) + at[0];
        if (is_full(grown)) {
            row_of(scratch, scratch->other, at[1], at[2])[at[0]] = *grown;
        } else {
            memcpy(scratch->growing[scratch->growing_count++], at, sizeof at);
        }
    }
}

/* Calls step for every brick that grows. */
typedef void brick_step(struct scratch *scratch, size_t i, size_t j, size_t k);

static void for_growing(struct scratch *scratch, brick_step *step)
{
    for (size_t n = 0; n < scratch->growing_count; n++) {
        step(scratch, scratch->growing[n][0], scratch->growing[n][1], scratch->growing[n][2]);
    }
}

/* Adds 1 to the code of every voxel that the growth has not reached. */
static void count_brick(struct scratch *scratch, size_t i, size_t j, size_t k)
{
    const struct bits *grown = row_of(scratch, scratch->grown, j, k) + i;
    struct bits *planes = row_of(scratch, 0, j, k) + i * PLANES;
    for (int w = 0; w < BRICK_WORDS; w++) {
        uint64_t carry = ~grown->word[w];
        for (int p = 0; p < PLANES; p++) {
            uint64_t *plane = &planes[p].word[w];
            uint64_t sum = *plane ^ carry;
            carry &= *plane;
            *plane = sum;
        }
    }
}

#define EVERY_ROW(byte) (UINT64_C(0x0101010101010101) * (byte))

static void grow_along_i(struct scratch *scratch, size_t i, size_t j, size_t k)
{
    const struct bits *from = row_of(scratch, scratch->grown, j, k) + i;
    const struct bits *before = i ? from - 1 : scratch->nothing;
    const struct bits *behind = i + 1 < scratch->bricks[0] ? from + 1 : scratch->nothing;
    struct bits *to = row_of(scratch, scratch->other, j, k) + i;
    for (int w = 0; w < BRICK_WORDS; w++) {
        uint64_t x = from->word[w];
        uint64_t up = (x << 1 & EVERY_ROW(0xfe)) | (before->word[w] >> 7 & EVERY_ROW(0x01));
        uint64_t down = (x >> 1 & EVERY_ROW(0x7f)) | (behind->word[w] << 7 & EVERY_ROW(0x80));
        to->word[w] = x | up | down;
    }
}

static void grow_along_j(struct scratch *scratch, size_t i, size_t j, size_t k)
{
    const struct bits *from = row_of(scratch, scratch->other, j, k) + i;
    const struct bits *before = row_or_nothing(scratch, scratch->other, j - 1, k) + i;
    const struct bits *behind = row_or_nothing(scratch, scratch->other, j + 1, k) + i;
    struct bits *to = row_of(scratch, scratch->grown, j, k) + i;
    for (int w = 0; w < BRICK_WORDS; w++) {
        uint64_t x = from->word[w];
        uint64_t up = x << 8 | before->word[w] >> 56;
        uint64_t down = x >> 8 | behind->word[w] << 56;
        to->word[w] = x | up | down;
    }
}

static void grow_along_k(struct scratch *scratch, size_t i, size_t j, size_t k)
{
    const struct bits *from = row_of(scratch, scratch->grown, j, k) + i;
    const struct bits *below = row_or_nothing(scratch, scratch->grown, j, k - 1) + i;
    const struct bits *above = row_or_nothing(scratch, scratch->grown, j, k + 1) + i;
    struct bits *to = row_of(scratch, scratch->other, j, k) + i;
    uint64_t before = below->word[BRICK_WORDS - 1];
    for (int w = 0; w < BRICK_WORDS; w++) {
        uint64_t after = w + 1 < BRICK_WORDS ? from->word[w + 1] : above->word[0];
        to->word[w] = before | from->word[w] | after;
        before = from->word[w];
    }
}

static void count_fine_distances(struct scratch *scratch)
{
    for (int level = 1; level < FINE_LEVELS; level++) {
        list_growing(scratch, level);
        for_growing(scratch, count_brick);
        for_growing(scratch, grow_along_i);
        for_growing(scratch, grow_along_j);
        for_growing(scratch, grow_along_k);
        size_t grown = scratch->other;
        scratch->other = scratch->grown;
        scratch->grown = grown;
    }
    for_growing(scratch, count_brick);
}

static void mark_distance_row(struct scratch *scratch, size_t j, size_t k)
{
    const struct bits *grown = row_of(scratch, scratch->grown, j, k);
    uint8_t *distance = distance_of(scratch, j, k);
    for (size_t b = 0; b < scratch->bricks[0]; b++) {
        uint64_t any = 0;
        for (int w = 0; w < BRICK_WORDS; w++) {
            any |= grown[b].word[w];
        }
        distance[b] = any ? 0 : FAR_BRICKS;
    }
}

/* Lowers a brick's distance to 1 + that of the 13 neighbours before it (sign 1) or behind it (sign -1). */
static void relax_brick(const struct scratch *scratch, uint8_t *distance, ptrdiff_t sign)
{
    uint8_t best = *distance;
    for (int n = 0; n < 13; n++) {
        ptrdiff_t offset = (n % 3 - 1) * scratch->stride[0] + (n / 3 % 3 - 1) * scratch->stride[1];
        offset -= n < 9 ? scratch->stride[2] : 0;
        uint8_t further = (uint8_t)(distance[sign * offset] + 1);
        best = further < best ? further : best;
    }
    *distance = best;
}

static void relax_row(struct scratch *scratch, size_t j, size_t k)
{
    for (size_t b = 0; b < scratch->bricks[0]; b++) {
        relax_brick(scratch, distance_of(scratch, j, k) + b, 1);
    }
}

/* In bricks: one sweep forwards, one backwards. */
static void count_brick_distances(struct scratch *scratch)
{
    for_rows(scratch, mark_distance_row);
    for_rows(scratch, relax_row);
    for (size_t k = scratch->bricks[2]; k-- > 0;) {
        for (size_t j = scratch->bricks[1]; j-- > 0;) {
            for (size_t b = scratch->bricks[0]; b-- > 0;) {
                relax_brick(scratch, distance_of(scratch, j, k) + b, -1);
            }
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
static uint8_t *line_of(const struct distance_map *map, const size_t brick[3], int part)
{
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = BRICK_LINES * brick[a] + (size_t)(part >> a & 1);
    }
    return map->codes + DISTANCE_LINE * (at[0] + map->lines[0] * (at[1] + map->lines[1] * at[2]));
}

static void write_fine_codes(const struct distance_map *map, const size_t brick[3], const struct bits planes[PLANES],
                             const uint64_t spread[256])
{
    for (int part = 0; part < 8; part += 2) {
        uint8_t *codes = line_of(map, brick, part);
        for (int at = 0; at < DISTANCE_LINE; at += DISTANCE_EDGE) {
            int y = at / DISTANCE_EDGE % DISTANCE_EDGE + (part & 2) * 2;
            int z = at / DISTANCE_EDGE / DISTANCE_EDGE + (part & 4);
            uint64_t eight = fine_codes(planes, y + BRICK * z, spread);
            uint8_t bytes[BRICK];
            memcpy(bytes, &eight, sizeof bytes);
            memcpy(codes + at, bytes, DISTANCE_EDGE);
            memcpy(codes + DISTANCE_LINE + at, bytes + DISTANCE_EDGE, DISTANCE_EDGE);
        }
    }
}

static void write_brick(const struct distance_map *map, const size_t brick[3], int distance,
                        const struct bits planes[PLANES], const uint64_t spread[256])
{
    int far = far_of(distance);
    for (int part = 0; part < 8 && far > FINE_LEVELS; part++) {
        memset(line_of(map, brick, part), far < UINT8_MAX ? far : UINT8_MAX, DISTANCE_LINE);
    }
    if (far <= FINE_LEVELS) {
        write_fine_codes(map, brick, planes, spread);
    }
}

/* Layer by layer, whose planes are copied to `planes` first, since the codes take their place. */
static void write_codes(const struct distance_map *map, const struct scratch *scratch, struct bits *planes)
{
    size_t row = scratch->bricks[0];
    uint64_t spread[256];
    make_spread(spread);
    for (size_t k = 0; k < scratch->bricks[2]; k++) {
        memcpy(planes, row_of(scratch, 0, 0, k), row * scratch->bricks[1] * PLANES * sizeof *planes);
        for (size_t b = 0; b < row * scratch->bricks[1]; b++) {
            const size_t brick[3] = {b % row, b / row, k};
            write_brick(map, brick, distance_of(scratch, brick[1], k)[brick[0]], planes + b * PLANES, spread);
        }
    }
}

/* A written map begins with the struct without its pointer, padded so that the codes lie in lines of the cache. */
enum { HEAD_SIZE = 192 };
static_assert(sizeof(struct distance_map) <= HEAD_SIZE, "the map fits in front of its codes");

/* The voxels that have codes: all, or of a sparse volume the box of its objects and a voxel around it, from a brick
 * on. */
static void find_part(size_t first[3], size_t dim[3], const struct volume *volume)
{
    const struct object_box *box = &volume->box;
    for (int a = 0; a < 3; a++) {
        bool is_empty = box->first[a] > box->last[a];
        bool is_part = volume->step_count && !is_empty && box->first[a] > 0;
        size_t end = !volume->step_count ? volume->info.dim[a] : is_empty ? 1 : box->last[a] + 2;
        first[a] = is_part ? (box->first[a] - 1) / BRICK * BRICK : 0;
        dim[a] = (end < volume->info.dim[a] ? end : volume->info.dim[a]) - first[a];
    }
}

/* Everything but the codes; gives the bytes that these need. */
static size_t set_dimensions(struct distance_map *map, const struct volume *volume)
{
    size_t part[3];
    *map = (struct distance_map){0};
    find_part(map->base, part, volume);
    for (int a = 0; a < 3; a++) {
        map->dim[a] = volume->info.dim[a];
        map->lines[a] = (part[a] + 2 * (size_t)DISTANCE_MARGIN + BRICK - 1) / BRICK * BRICK_LINES;
    }
    return distance_map_codes(map); /* not much more than the number of voxels, which was checked */
}

/* Fills the codes of a map whose dimensions are set with distances to the marked voxels, and sets the box of these. */
static conus_status fill_dense(struct distance_map *map, const struct volume *volume, row_mark *mark)
{
    struct scratch scratch;
    conus_status status = scratch_init(&scratch, map);
    struct bits *planes = status ? NULL : memory_raw(scratch.bricks[0] * scratch.bricks[1], PLANES * sizeof *planes);
    status = planes ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        for (size_t k = 0; k < volume->info.dim[2]; k++) {
            for (size_t j = 0; j < volume->info.dim[1]; j++) {
                mark(&scratch, volume, j, k, volume->info.dim[0] * (j + volume->info.dim[1] * k));
            }
        }
        find_box(map, &scratch);
        count_brick_distances(&scratch);
        count_fine_distances(&scratch);
        write_codes(map, &scratch, planes);
    }
    memory_free(planes);
    memory_free(scratch.nothing);
    memory_free(scratch.growing);
    memory_free(scratch.distance);
    memory_free(scratch.beside);
    return status;
}

/* The same of any volume: a sparse one is spread where its objects are. */
static conus_status fill_codes(struct distance_map *map, const struct volume *volume, row_mark *mark)
{
    struct volume spread;
    struct distance_map part = *map;
    size_t first[3];
    if (!volume->step_count) {
        return fill_dense(map, volume, mark);
    }
    find_part(first, part.dim, volume);
    conus_status status = volume_spread(&spread, volume, first, part.dim);
    if (!status) {
        status = fill_dense(&part, &spread, mark);
        volume_finish(&spread);
    }
    for (int a = 0; a < 3; a++) {
        map->first[a] = part.first[a] + (double)first[a];
        map->last[a] = part.last[a] + (double)first[a];
    }
    return status;
}

size_t distance_map_size(const struct volume *volume)
{
    struct distance_map map;
    return HEAD_SIZE + set_dimensions(&map, volume);
}

conus_status distance_map_write(void *memory, const struct volume *volume)
{
    struct distance_map map;
    size_t size = set_dimensions(&map, volume);
    if (volume->distances) {
        memcpy(memory, volume->distances, HEAD_SIZE + size);
        return CONUS_OK;
    }
    map.codes = (uint8_t *)memory + HEAD_SIZE;
    conus_status status = fill_codes(&map, volume, mark_occupied);
    map.codes = NULL;
    memset(memory, 0, HEAD_SIZE);
    memcpy(memory, &map, sizeof map);
    return status;
}

/* The box is empty, or of whole numbers within the voxels that have codes. */
static bool box_is_sound(const struct distance_map *map, const size_t part[3])
{
    bool is_empty = true;
    bool sound = true;
    for (int a = 0; a < 3; a++) {
        is_empty =
            is_empty && map->first[a] == (double)(map->base[a] + part[a]) && map->last[a] == (double)map->base[a] - 1;
        sound = sound && map->first[a] >= (double)map->base[a] && map->last[a] >= map->first[a] &&
                map->last[a] < (double)(map->base[a] + part[a]) && map->first[a] == floor(map->first[a]) &&
                map->last[a] == floor(map->last[a]);
    }
    return is_empty || sound;
}

/* Whether a position along an axis, the margin included, is in the box. */
static bool is_in_box(const struct distance_map *map, int a, size_t position)
{
    double at = (double)(map->base[a] + position) - DISTANCE_MARGIN;
    return at >= map->first[a] && at <= map->last[a];
}

/* Whether all positions of a line along an axis are. */
static bool line_is_in_box(const struct distance_map *map, int a, size_t line)
{
    return is_in_box(map, a, DISTANCE_EDGE * line) && is_in_box(map, a, DISTANCE_EDGE * line + DISTANCE_EDGE - 1);
}

static bool has_zero(const uint8_t line[DISTANCE_LINE])
{
    uint8_t least = UINT8_MAX;
    for (size_t c = 0; c < DISTANCE_LINE; c++) {
        least = line[c] < least ? line[c] : least;
    }
    return !least;
}

/* Whether no code but those of the box is 0 in the line at `at`. */
static bool line_is_sound(const struct distance_map *map, const size_t at[3])
{
    const uint8_t *codes = map->codes + DISTANCE_LINE * (at[0] + map->lines[0] * (at[1] + map->lines[1] * at[2]));
    bool sound = true;
    for (size_t c = 0; c < DISTANCE_LINE && has_zero(codes) && sound; c++) {
        sound = codes[c] || (is_in_box(map, 0, DISTANCE_EDGE * at[0] + c % DISTANCE_EDGE) &&
                             is_in_box(map, 1, DISTANCE_EDGE * at[1] + c / DISTANCE_EDGE % DISTANCE_EDGE) &&
                             is_in_box(map, 2, DISTANCE_EDGE * at[2] + c / DISTANCE_EDGE / DISTANCE_EDGE));
    }
    return sound;
}

/* The same of a row of lines along i; those in the box are passed over. */
static bool row_is_sound(const struct distance_map *map, size_t j, size_t k)
{
    const bool is_in = line_is_in_box(map, 1, j) && line_is_in_box(map, 2, k);
    bool sound = true;
    for (size_t i = 0; i < map->lines[0] && sound; i++) {
        sound = (is_in && line_is_in_box(map, 0, i)) || line_is_sound(map, (const size_t[3]){i, j, k});
    }
    return sound;
}

bool distance_map_is_sound(const void *memory, const struct volume *volume)
{
    struct distance_map map;
    struct distance_map fits;
    size_t first[3];
    size_t part[3];
    memcpy(&map, memory, sizeof map);
    set_dimensions(&fits, volume);
    find_part(first, part, volume);
    if (memcmp(map.dim, fits.dim, sizeof map.dim) != 0 || memcmp(map.base, fits.base, sizeof map.base) != 0 ||
        memcmp(map.lines, fits.lines, sizeof map.lines) != 0 || map.shift || map.least || map.block ||
        !box_is_sound(&map, part)) {
        return false;
    }
    map.codes = (uint8_t *)memory + HEAD_SIZE; /* is only read */
    bool sound = true;
    for (size_t row = 0; row < map.lines[1] * map.lines[2] && sound; row++) {
        sound = row_is_sound(&map, row % map.lines[1], row / map.lines[1]);
    }
    return sound;
}

/* A map with memory of its own. */
static conus_status make_map(struct distance_map *out, const struct volume *volume, row_mark *mark)
{
    struct distance_map map;
    size_t size = set_dimensions(&map, volume);
    map.block = memory_raw(size / DISTANCE_LINE + 1, DISTANCE_LINE);
    map.codes = distance_map_on_lines(map.block);
    conus_status status = map.block ? fill_codes(&map, volume, mark) : CONUS_ERROR_MEMORY;
    if (status) {
        distance_map_finish(&map);
        return status;
    }
    *out = map;
    return CONUS_OK;
}

conus_status distance_map_init(struct distance_map *out, const struct volume *volume)
{
    if (volume->distances) {
        memcpy(out, volume->distances, sizeof *out);
        out->codes = (uint8_t *)volume->distances + HEAD_SIZE; /* is only read */
        out->block = NULL;
        return CONUS_OK;
    }
    return make_map(out, volume, mark_occupied);
}

/* Sets out[i] where voxels i of two rows differ; with an `other` of NULL, where the row holds an object. */
static void note_differences(uint8_t *out, const struct volume *volume, size_t row, const size_t *other)
{
    size_t dim = volume->info.dim[0];
    if (volume->objects16) {
        const uint16_t *objects = volume->objects16;
        for (size_t i = 0; i < dim; i++) {
            out[i] |= objects[row + i] != (other ? objects[*other + i] : 0);
        }
    } else {
        const uint32_t *objects = volume->objects32;
        for (size_t i = 0; i < dim; i++) {
            out[i] |= objects[row + i] != (other ? objects[*other + i] : 0);
        }
    }
}

/* Sets beside[i] where voxel i differs from one of the eight with the same i around it. */
static void look_beside(uint8_t *beside, const struct volume *volume, size_t j, size_t k, size_t voxel)
{
    const size_t *dim = volume->info.dim;
    for (int n = 0; n < 9; n++) {
        size_t y = j + (size_t)(n % 3) - 1; /* wraps in front of the first */
        size_t z = k + (size_t)(n / 3) - 1;
        size_t other = dim[0] * (y + dim[1] * z);
        if (n != 4) {
            note_differences(beside, volume, voxel, y < dim[1] && z < dim[2] ? &other : NULL);
        }
    }
}

/* Marks the voxels with another content among the 26 around them; beside the grid there is nothing. */
static void mark_borders(struct scratch *scratch, const struct volume *volume, size_t j, size_t k, size_t voxel)
{
    size_t dim = volume->info.dim[0];
    size_t y = j + DISTANCE_MARGIN;
    size_t z = k + DISTANCE_MARGIN;
    struct bits *bricks = row_of(scratch, scratch->grown, y / BRICK, z / BRICK);
    uint8_t *beside = scratch->beside + 1; /* one more at either end, always 0 */
    memset(beside, 0, dim);
    look_beside(beside, volume, j, k, voxel);
    uint32_t before = 0;
    uint32_t here = volume_object(volume, voxel);
    for (size_t i = 0; i < dim; i++) {
        uint32_t after = i + 1 < dim ? volume_object(volume, voxel + i + 1) : 0;
        size_t x = i + DISTANCE_MARGIN;
        if (before != here || after != here || beside[i] || beside[(ptrdiff_t)i - 1] || beside[i + 1]) {
            bricks[x / BRICK].word[z % BRICK] |= UINT64_C(1) << (x % BRICK + BRICK * (y % BRICK));
        }
        before = here;
        here = after;
    }
}

/* The code of a border is 1. All voxels up to the nearest border have the same content, that border among them: so the
 * code is 1 + its distance, up to a limit. */
static uint8_t uniform_code(uint8_t distance, uint32_t object, const struct object_colours *colours)
{
    int most = object ? UNIFORM_RADIUS : UNIFORM_EMPTY_RADIUS;
    int radius = distance < most ? distance + 1 : most;
    return (uint8_t)(radius | (object ? object_colour(colours, object) * 0x10 : UNIFORM_EMPTY));
}

/* Distances to borders become codes. Beside the grid, where any voxel may be a border, all are as a border's. */
static void make_uniform(struct distance_map *map, const struct volume *volume, const struct object_colours *colours)
{
    const size_t *dim = volume->info.dim;
    for (size_t z = 0; z < DISTANCE_EDGE * map->lines[2]; z++) {
        for (size_t y = 0; y < DISTANCE_EDGE * map->lines[1]; y++) {
            for (size_t x = 0; x < DISTANCE_EDGE * map->lines[0]; x++) {
                size_t i = map->base[0] + x - DISTANCE_MARGIN; /* wraps in front of the first */
                size_t j = map->base[1] + y - DISTANCE_MARGIN;
                size_t k = map->base[2] + z - DISTANCE_MARGIN;
                uint8_t *code = &map->codes[distance_map_at(map, i, j, k)];
                *code = i < dim[0] && j < dim[1] && k < dim[2]
                            ? uniform_code(*code, volume_object(volume, i + dim[0] * (j + dim[1] * k)), colours)
                            : UNIFORM_EMPTY | 1;
            }
        }
    }
}

conus_status distance_map_init_uniform(struct distance_map *out, const struct volume *volume,
                                       const struct distance_map *map)
{
    struct distance_map uniform;
    struct object_colours colours;
    struct volume spread = {0};
    size_t first[3];
    size_t dim[3];
    find_part(first, dim, volume);
    conus_status status = volume->step_count ? volume_spread(&spread, volume, first, dim) : CONUS_OK;
    status = status ? status : object_colours_find(&colours, volume->step_count ? &spread : volume);
    volume_finish(&spread);
    status = status ? status : make_map(&uniform, volume, mark_borders);
    if (!status) {
        memcpy(uniform.first, map->first, sizeof map->first);
        memcpy(uniform.last, map->last, sizeof map->last);
        make_uniform(&uniform, volume, &colours);
        *out = uniform;
    }
    return status;
}
