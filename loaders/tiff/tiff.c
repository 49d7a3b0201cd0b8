/* SPDX-License-Identifier: BSD-3-Clause */
/* Follows the chain of directories, checks that the pages make a stack that the file can hold, and unpacks it. */
#include "loaders/tiff/tiff.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/threads.h"
#include "sources/source.h"

#include <libdeflate.h>
#include <stdio.h>
#include <string.h>

/* TIFF 6.0, and SGI's two fields of depth. */
#define FIELDS(ROW)                                                                                                    \
    ROW(SUBFILE, 254, "NewSubfileType"), ROW(WIDTH, 256, "ImageWidth"), ROW(LENGTH, 257, "ImageLength"),               \
        ROW(BITS, 258, "BitsPerSample"), ROW(COMPRESSION, 259, "Compression"),                                         \
        ROW(PHOTOMETRIC, 262, "PhotometricInterpretation"), ROW(FILL_ORDER, 266, "FillOrder"),                         \
        ROW(DESCRIPTION, 270, "ImageDescription"), ROW(STRIP_OFFSETS, 273, "StripOffsets"),                            \
        ROW(ORIENTATION, 274, "Orientation"), ROW(SAMPLES, 277, "SamplesPerPixel"),                                    \
        ROW(STRIP_ROWS, 278, "RowsPerStrip"), ROW(STRIP_COUNTS, 279, "StripByteCounts"),                               \
        ROW(PLANAR, 284, "PlanarConfiguration"), ROW(PREDICTOR, 317, "Predictor"), ROW(TILE_WIDTH, 322, "TileWidth"),  \
        ROW(TILE_LENGTH, 323, "TileLength"), ROW(TILE_OFFSETS, 324, "TileOffsets"),                                    \
        ROW(TILE_COUNTS, 325, "TileByteCounts"), ROW(FORMAT, 339, "SampleFormat"), ROW(DEPTH, 32997, "ImageDepth"),    \
        ROW(TILE_DEPTH, 32998, "TileDepth")
#define FIELD_ID(id, tag, name) id
#define FIELD_ROW(id, tag, name)                                                                                       \
    {                                                                                                                  \
        tag, name                                                                                                      \
    }

enum field { FIELDS(FIELD_ID), FIELD_COUNT };

static const struct {
    uint16_t tag;
    const char *name;
} fields[] = {FIELDS(FIELD_ROW)};

enum { SIDE_LIMIT = INT32_MAX, TILE_LIMIT = 1 << 28 /* bytes of a tile, unpacked */ };

/* A directory while it is read. */
struct directory {
    const struct tiff_file *file;
    struct tiff_list lists[FIELD_COUNT];
};

static bool tiff_has(const struct tiff_file *file, uint64_t at, uint64_t size)
{
    return at <= file->size && size <= file->size - at;
}

/* The number of `size` bytes (1, 2, 4, 8) at `at`, which is inside the file. */
static uint64_t tiff_number(const struct tiff_file *file, uint64_t at, size_t size)
{
    return (uint64_t)order_whole(file->data + at, size, false, file->swapped);
}

static uint64_t tiff_list_at(const struct tiff_file *file, const struct tiff_list *list, uint64_t index)
{
    return tiff_number(file, list->at + index * list->size, list->size);
}

/* Bytes of a value of the TIFF type, 0 of one that no field of the table may have. */
static size_t type_size(enum field field, uint64_t type)
{
    enum { BYTE = 1, ASCII = 2, SHORT = 3, LONG = 4, LONG8 = 16 };
    if (field == DESCRIPTION) {
        return type == ASCII || type == BYTE;
    }
    return type == BYTE ? 1 : type == SHORT ? 2 : type == LONG ? 4 : type == LONG8 ? 8 : 0;
}

static void read_value(struct job *job, struct directory *directory, enum field field, uint64_t at)
{
    const struct tiff_file *file = directory->file;
    size_t width = file->big ? 8 : 4; /* of the count, and of what is stored in the entry itself */
    uint64_t type = tiff_number(file, at + 2, 2);
    uint64_t count = tiff_number(file, at + 4, width);
    uint64_t value = at + 4 + width;
    struct tiff_list *list = &directory->lists[field];
    size_t size = type_size(field, type);
    if (list->count) {
        job_bad(job, "%s: is there twice", fields[field].name);
    }
    if (!size || !count) {
        job_bad(job, "%s: found %llu values of type %llu, %s is needed", fields[field].name, (unsigned long long)count,
                (unsigned long long)type, field == DESCRIPTION ? "a text" : "a whole number (types 1, 3, 4, 16)");
        return;
    }
    value = count > width / size ? tiff_number(file, value, width) : value;
    if (count > file->size / size || !tiff_has(file, value, count * size)) {
        job_bad(job, "%s: %llu values at byte %llu, the file has %zu bytes", fields[field].name,
                (unsigned long long)count, (unsigned long long)value, file->size);
        return;
    }
    *list = (struct tiff_list){value, count, size};
}

/* Gives where the next directory lies, 0 after the last and after a failure. */
static uint64_t read_entries(struct job *job, struct directory *directory, uint64_t at)
{
    const struct tiff_file *file = directory->file;
    size_t head = file->big ? 8 : 2;
    size_t entry = file->big ? 20 : 12;
    size_t tail = file->big ? 8 : 4;
    uint64_t count = tiff_has(file, at, head) ? tiff_number(file, at, head) : 0;
    if (!count || count > UINT16_MAX || !tiff_has(file, at, head + count * entry + tail)) {
        job_bad(job, "directory: %llu entries at byte %llu, the file has %zu bytes", (unsigned long long)count,
                (unsigned long long)at, file->size);
        return 0;
    }
    for (uint64_t i = 0; job_ok(job) && i < count; i++) {
        uint64_t start = at + head + i * entry;
        uint64_t tag = tiff_number(file, start, 2);
        for (int field = 0; field < FIELD_COUNT; field++) {
            if (fields[field].tag == tag) {
                read_value(job, directory, (enum field)field, start);
            }
        }
    }
    return tiff_number(file, at + head + count * entry, tail);
}

/* The one number of a field, or `absent` where it is not there. */
static uint64_t read_one(struct job *job, const struct directory *directory, enum field field, uint64_t absent)
{
    const struct tiff_list *list = &directory->lists[field];
    if (list->count > 1) {
        job_bad(job, "%s: found %llu numbers, one is needed", fields[field].name, (unsigned long long)list->count);
    }
    return list->count ? tiff_list_at(directory->file, list, 0) : absent;
}

/* A length in pixels; 1 after a failure. */
static uint64_t read_side(struct job *job, const struct directory *directory, enum field field)
{
    const uint64_t side = read_one(job, directory, field, 0);
    const bool is_good = side >= 1 && side <= SIDE_LIMIT;
    if (!directory->lists[field].count) {
        job_bad(job, "%s: is missing", fields[field].name);
    } else if (!is_good) {
        job_bad(job, "%s: found %llu, allowed are 1 to 2147483647", fields[field].name, (unsigned long long)side);
    }
    return is_good ? side : 1;
}

static void check_plain_fields(struct job *job, const struct directory *directory)
{
    static const struct {
        enum field field;
        uint64_t absent, first, second;
        const char *allowed;
    } checks[] = {
        {SAMPLES, 1, 1, 1, "1: one number a pixel, no colours (RGB)"},
        {PHOTOMETRIC, 1, 1, 3, "1 (black is zero) and 3 (a palette, whose indices are taken)"},
        {SUBFILE, 0, 0, 2, "0 and 2: pages, no smaller copies and no masks"},
        {FILL_ORDER, 1, 1, 1, "1"},
        {ORIENTATION, 1, 1, 1, "1 (the first row is the top, the first column the left)"},
        {PLANAR, 1, 1, 2, "1 and 2"},
        {DEPTH, 1, 1, 1, "1: a page a slice"},
        {TILE_DEPTH, 1, 1, 1, "1: a page a slice"},
    };
    for (size_t i = 0; i < sizeof checks / sizeof checks[0]; i++) {
        const uint64_t value = read_one(job, directory, checks[i].field, checks[i].absent);
        if (value != checks[i].first && value != checks[i].second) {
            job_refuse(job, "%s: found %llu, allowed is %s", fields[checks[i].field].name, (unsigned long long)value,
                       checks[i].allowed);
        }
    }
}

static void read_pixel(struct job *job, struct tiff_page *page, const struct directory *directory)
{
    const uint64_t bits = read_one(job, directory, BITS, 1);
    const uint64_t format = read_one(job, directory, FORMAT, TIFF_UNSIGNED);
    bool whole = bits == 8 || bits == 16 || bits == 32 || bits == 64;
    bool known = whole && format >= TIFF_UNSIGNED && format <= TIFF_FLOAT && (format != TIFF_FLOAT || bits >= 32);
    if (!known) {
        job_refuse(job,
                   "BitsPerSample: found %llu of SampleFormat %llu, allowed are 8, 16, 32 and 64 of 1 (unsigned) and 2 "
                   "(signed), 32 and 64 of 3 (float)",
                   (unsigned long long)bits, (unsigned long long)format);
        return;
    }
    page->bits = (unsigned)bits;
    page->format = (enum tiff_format)format;
}

static void read_compression(struct job *job, struct tiff_page *page, const struct directory *directory)
{
    enum { OLD_DEFLATE = 32946 };
    uint64_t method = read_one(job, directory, COMPRESSION, TIFF_PLAIN);
    const uint64_t predictor = read_one(job, directory, PREDICTOR, 1);
    method = method == OLD_DEFLATE ? TIFF_DEFLATE : method;
    if (method != TIFF_PLAIN && method != TIFF_LZW && method != TIFF_DEFLATE) {
        job_refuse(job, "Compression: found %llu, allowed are 1 (none), 5 (LZW) and 8 (deflate)",
                   (unsigned long long)method);
    } else if (predictor < 1 || predictor > (method == TIFF_PLAIN ? 1 : 2)) {
        job_refuse(job, "Predictor: found %llu, allowed are 1 and, of LZW and deflate, 2",
                   (unsigned long long)predictor);
    }
    page->compression = (enum tiff_compression)method;
    page->differences = predictor == 2;
}

static void read_tiles(struct job *job, struct tiff_page *page, const struct directory *directory)
{
    page->chunk_width = read_side(job, directory, TILE_WIDTH);
    page->chunk_length = read_side(job, directory, TILE_LENGTH);
    if (page->chunk_width > TILE_LIMIT / (page->bits / 8) / page->chunk_length) {
        job_refuse(job, "TileWidth: %llu x %llu pixels of %u bits, allowed are %d bytes a tile",
                   (unsigned long long)page->chunk_width, (unsigned long long)page->chunk_length, page->bits,
                   TILE_LIMIT);
    }
    page->offsets = directory->lists[TILE_OFFSETS];
    page->counts = directory->lists[TILE_COUNTS];
}

static void read_strips(struct job *job, struct tiff_page *page, const struct directory *directory)
{
    const uint64_t rows = read_one(job, directory, STRIP_ROWS, page->length);
    if (!rows) {
        job_bad(job, "RowsPerStrip: found 0, allowed is 1 or more");
    }
    page->chunk_width = page->width;
    page->chunk_length = rows && rows < page->length ? rows : page->length;
    page->offsets = directory->lists[STRIP_OFFSETS];
    page->counts = directory->lists[STRIP_COUNTS];
}

static void read_chunks(struct job *job, struct tiff_page *page, const struct directory *directory)
{
    static const enum field tile_fields[] = {TILE_WIDTH, TILE_LENGTH, TILE_OFFSETS, TILE_COUNTS};
    for (size_t i = 0; i < sizeof tile_fields / sizeof tile_fields[0]; i++) {
        page->tiled = page->tiled || directory->lists[tile_fields[i]].count;
    }
    if (page->tiled && (directory->lists[STRIP_OFFSETS].count || directory->lists[STRIP_COUNTS].count)) {
        job_bad(job, "StripOffsets: the page has tiles as well, one of them is allowed");
    }
    (page->tiled ? read_tiles : read_strips)(job, page, directory);
    page->across = (page->width + page->chunk_width - 1) / page->chunk_width;
    page->down = (page->length + page->chunk_length - 1) / page->chunk_length;
    const uint64_t wanted = page->across * page->down; /* each below 2^31 */
    const struct tiff_list *lists[] = {&page->offsets, &page->counts};
    for (size_t i = 0; i < 2; i++) {
        if (lists[i]->count != wanted) {
            job_bad(job, "%s: found %llu numbers, the page has %llu %s",
                    fields[page->tiled ? TILE_OFFSETS + i
                           : i         ? STRIP_COUNTS
                                       : STRIP_OFFSETS]
                        .name,
                    (unsigned long long)lists[i]->count, (unsigned long long)wanted, page->tiled ? "tiles" : "strips");
        }
    }
}

/* Reads the directory at `at`; gives where the next one lies, 0 after the last and after a failure. */
static uint64_t read_directory(struct job *job, struct tiff_page *page, const struct tiff_file *file, uint64_t at)
{
    struct directory directory = {.file = file};
    const uint64_t next = read_entries(job, &directory, at);
    check_plain_fields(job, &directory);
    page->width = read_side(job, &directory, WIDTH);
    page->length = read_side(job, &directory, LENGTH);
    read_pixel(job, page, &directory);
    if (!job_ok(job)) { /* its pixels may have no bits */
        return 0;
    }
    read_compression(job, page, &directory);
    read_chunks(job, page, &directory);
    const struct tiff_list *text = &directory.lists[DESCRIPTION];
    page->description = (struct text){(const char *)file->data + text->at, text->count};
    return job_ok(job) ? next : 0;
}

/* Memory that the chunks of one file share; begins zeroed. */
struct tiff_unpacker {
    struct libdeflate_decompressor *deflate;
    struct tiff_lzw *lzw;
};

struct tiff_chunk {
    const uint8_t *packed;
    size_t packed_size;
    uint8_t *out;         /* [rows * width * bits / 8] */
    uint64_t width, rows; /* Pixels that are stored. */
};

static conus_status unpack_deflate(struct tiff_unpacker *unpacker, const struct tiff_chunk *chunk, size_t size)
{
    unpacker->deflate = unpacker->deflate ? unpacker->deflate : libdeflate_alloc_decompressor();
    if (!unpacker->deflate) {
        return CONUS_ERROR_MEMORY;
    }
    size_t got = 0;
    enum libdeflate_result result =
        libdeflate_zlib_decompress(unpacker->deflate, chunk->packed, chunk->packed_size, chunk->out, size, &got);
    return result == LIBDEFLATE_SUCCESS && got == size ? CONUS_OK : CONUS_ERROR_DATA;
}

static conus_status unpack_lzw(struct tiff_unpacker *unpacker, const struct tiff_chunk *chunk, size_t size)
{
    unpacker->lzw = unpacker->lzw ? unpacker->lzw : memory_raw(1, sizeof *unpacker->lzw);
    if (!unpacker->lzw) {
        return CONUS_ERROR_MEMORY;
    }
    return tiff_lzw_unpack(chunk->out, size, chunk->packed, chunk->packed_size, unpacker->lzw) ? CONUS_OK
                                                                                               : CONUS_ERROR_DATA;
}

/* Defines how the pixels of one size in a row become sums of all up to each. */
#define DEFINE_SUMS(name, type, read, swap)                                                                            \
    static void name(uint8_t *row, size_t count, bool swapped)                                                         \
    {                                                                                                                  \
        type sum = 0;                                                                                                  \
        for (size_t i = 0; i < count; i++) {                                                                           \
            sum = (type)(sum + read(row + i * sizeof sum, swapped));                                                   \
            type stored = swapped ? swap(sum) : sum;                                                                   \
            memcpy(row + i * sizeof sum, &stored, sizeof stored);                                                      \
        }                                                                                                              \
    }

static uint8_t read_byte(const uint8_t *data, bool swapped)
{
    (void)swapped;
    return *data;
}

DEFINE_SUMS(sum_8, uint8_t, read_byte, (uint8_t))
DEFINE_SUMS(sum_16, uint16_t, order_u16, __builtin_bswap16)
DEFINE_SUMS(sum_32, uint32_t, order_u32, __builtin_bswap32)
DEFINE_SUMS(sum_64, uint64_t, order_u64, __builtin_bswap64)

static void undo_differences(const struct tiff_page *page, const struct tiff_chunk *chunk, bool swapped)
{
    size_t row_bytes = chunk->width * (page->bits / 8);
    void (*sum)(uint8_t *, size_t, bool) = page->bits == 8    ? sum_8
                                           : page->bits == 16 ? sum_16
                                           : page->bits == 32 ? sum_32
                                                              : sum_64;
    for (uint64_t row = 0; row < chunk->rows; row++) {
        sum(chunk->out + row * row_bytes, chunk->width, swapped);
    }
}

/* Unpacks `chunk` of `page`, and undoes its differences. Pixels stay in the byte order of the file, which is the
 * other than this machine's where it is `swapped`. Without a message: CONUS_ERROR_DATA where the packed bytes are
 * damaged, or hold fewer or more than the chunk. */
static conus_status tiff_chunk_unpack(struct tiff_unpacker *unpacker, const struct tiff_page *page,
                                      const struct tiff_chunk *chunk, bool swapped)
{
    size_t size = chunk->width * chunk->rows * (page->bits / 8);
    conus_status status = CONUS_OK;
    if (page->compression == TIFF_PLAIN) {
        memcpy(chunk->out, chunk->packed, size); /* as many are there: checked with the directory */
    } else {
        status =
            page->compression == TIFF_LZW ? unpack_lzw(unpacker, chunk, size) : unpack_deflate(unpacker, chunk, size);
    }
    if (!status && page->differences) {
        undo_differences(page, chunk, swapped);
    }
    return status;
}

static uint64_t read_header(struct job *job, struct tiff_file *file)
{
    if (!tiff_is(file->data, file->size)) {
        job_bad(job, "magic: no TIFF file");
        return 0;
    }
    bool big_endian = file->data[0] == 'M';
    file->swapped = big_endian == BIG_ENDIAN_IS_SWAPPED;
    file->big = file->data[big_endian ? 3 : 2] == '+';
    if (!tiff_has(file, 0, file->big ? 16 : 8)) {
        job_bad(job, "header: found %zu bytes, TIFF needs %d", file->size, file->big ? 16 : 8);
        return 0;
    }
    if (file->big && (tiff_number(file, 4, 2) != 8 || tiff_number(file, 6, 2) != 0)) {
        job_bad(job, "header: found offsets of %u bytes, BigTIFF has 8", (unsigned)tiff_number(file, 4, 2));
    }
    const uint64_t first = file->big ? tiff_number(file, 8, 8) : tiff_number(file, 4, 4);
    if (!first) {
        job_bad(job, "header: there is no directory");
    }
    return first;
}

static void compare_pages(struct job *job, const struct tiff_page *a, const struct tiff_page *b)
{
    if (a->width != b->width || a->length != b->length || a->bits != b->bits || a->format != b->format) {
        job_bad(job,
                "%llu x %llu pixels of %u bits, SampleFormat %d, but page 0 has %llu x %llu of %u bits, SampleFormat "
                "%d: all must be alike",
                (unsigned long long)b->width, (unsigned long long)b->length, b->bits, (int)b->format,
                (unsigned long long)a->width, (unsigned long long)a->length, a->bits, (int)a->format);
    }
}

/* Stops at a directory that comes again: `seen` is one of those before, moved on at 1, 2, 4, ... pages (Brent). */
static void read_pages(struct job *job, struct tiff *tiff, uint64_t at)
{
    uint64_t seen = 0;
    for (size_t i = 0; at && job_ok(job); i++) {
        if (at == seen) {
            job_bad(job, "directory: that at byte %llu follows on itself", (unsigned long long)at);
        } else if (i == TIFF_PAGE_LIMIT) {
            job_refuse(job, "directory: more than %d pages", TIFF_PAGE_LIMIT);
        }
        seen = (i & (i - 1)) == 0 ? at : seen;
        struct tiff_page *page = LIST_ADD(job, &tiff->pages);
        const size_t place = job_in(job, "page ", i);
        if (job_ok(job)) {
            at = read_directory(job, page, &tiff->file, at);
            compare_pages(job, &tiff->pages.at[0], page);
        }
        job_out(job, place);
    }
}

/* Rows of the chunk `index` of a page that are stored. */
static uint64_t stored_rows(const struct tiff_page *page, uint64_t index)
{
    uint64_t top = index / page->across * page->chunk_length;
    uint64_t left = page->length - top;
    return page->tiled || left > page->chunk_length ? page->chunk_length : left;
}

/* Bytes of the chunk, unpacked; at most those of a page or of a tile, which can be counted. */
static uint64_t chunk_bytes(const struct tiff_page *page, uint64_t index)
{
    return page->chunk_width * stored_rows(page, index) * (page->bits / 8);
}

static void check_chunk(struct job *job, const struct tiff *tiff, const struct tiff_page *page, uint64_t index)
{
    uint64_t at = tiff_list_at(&tiff->file, &page->offsets, index);
    uint64_t count = tiff_list_at(&tiff->file, &page->counts, index);
    uint64_t wanted = chunk_bytes(page, index);
    const char *words = page->tiled ? "tile" : "strip";
    if (!at || !count || !tiff_has(&tiff->file, at, count)) {
        job_bad(job, "%s %llu: %llu bytes at byte %llu, the file has %zu bytes", words, (unsigned long long)index,
                (unsigned long long)count, (unsigned long long)at, tiff->file.size);
    }
    /* Packed bytes this many times fewer cannot hold a chunk: of deflate, a match of 258 bytes takes 2 bits; of LZW,
     * the longest string that 4096 codes can make takes 9 bits or more. */
    uint64_t largest_ratio = page->compression == TIFF_LZW ? 4096 : 1032;
    bool plain = page->compression == TIFF_PLAIN;
    if (plain ? count != wanted : wanted / largest_ratio > count) {
        job_bad(job, "%s %llu: %llu bytes, its %llu x %llu pixels of %u bits are %llu%s", words,
                (unsigned long long)index, (unsigned long long)count, (unsigned long long)page->chunk_width,
                (unsigned long long)stored_rows(page, index), page->bits, (unsigned long long)wanted,
                plain ? "" : " unpacked, which so few cannot hold");
    }
}

/* Checks the chunks of a page; `total` grows by their stored bytes, `end` is where the one before ended. */
static void check_page(struct job *job, struct tiff *tiff, const struct tiff_page *page, uint64_t *total, uint64_t *end)
{
    tiff->whole = tiff->whole && page->compression == TIFF_PLAIN && !page->tiled;
    for (uint64_t i = 0; job_ok(job) && i < page->across * page->down; i++) {
        uint64_t at = tiff_list_at(&tiff->file, &page->offsets, i);
        uint64_t count = tiff_list_at(&tiff->file, &page->counts, i);
        check_chunk(job, tiff, page, i);
        tiff->start = *end ? tiff->start : at;
        tiff->whole = tiff->whole && (!*end || at == *end);
        *end = at + count;
        *total += count;
        if (*total > tiff->file.size) {
            job_bad(job, "%s: those up to here have more bytes together than the file: they overlap",
                    page->tiled ? "TileByteCounts" : "StripByteCounts");
        }
    }
}

static void check_pages(struct job *job, struct tiff *tiff)
{
    const struct tiff_page *first = &tiff->pages.at[0];
    uint64_t total = 0;
    uint64_t end = 0;
    uint64_t pixels = first->width * first->length; /* each below 2^31 */
    if (pixels > (UINT64_C(1) << 62) / TIFF_PAGE_LIMIT / 8) {
        job_bad(job, "ImageWidth: %llu x %llu pixels, more than any file can hold", (unsigned long long)first->width,
                (unsigned long long)first->length);
    }
    tiff->page_bytes = pixels * (first->bits / 8);
    double stack = (double)tiff->page_bytes * (double)tiff->pages.count;
    double tiles = (double)(first->across * first->down) * (double)(first->chunk_width * first->chunk_length) /
                   (double)pixels * stack;
    if (!memory_chunks_fit(tiles, stack)) {
        job_bad(job, "TileWidth: tiles of %llu x %llu pixels, far larger than pages of %llu x %llu",
                (unsigned long long)first->chunk_width, (unsigned long long)first->chunk_length,
                (unsigned long long)first->width, (unsigned long long)first->length);
    }
    tiff->whole = true;
    for (size_t i = 0; job_ok(job) && i < tiff->pages.count; i++) {
        const size_t place = job_in(job, "page ", i);
        check_page(job, tiff, &tiff->pages.at[i], &total, &end);
        job_out(job, place);
    }
}

/* The number behind "key=" at the start of a line of ImageJ's description; `absent` where there is none. */
static uint64_t imagej_number(struct job *job, struct text text, const char *key, uint64_t absent)
{
    const size_t length = strlen(key);
    struct text line;
    uint64_t number = 0;
    while (text_line(&text, &line)) {
        if (text_starts(line, key) && line.size > length && line.data[length] == '=') {
            struct text value = {line.data + length + 1, line.size - length - 1};
            if (!text_to_uint(text_trim(value), UINT32_MAX, &number) || !number) {
                job_bad(job, "ImageDescription: %s: a whole number above 0 is needed", key);
            }
            return number;
        }
    }
    return absent;
}

/* Reads ImageJ's own description of stacks; those above 4 GB have one directory, with all pages after it. */
static void read_imagej(struct job *job, struct tiff *tiff)
{
    struct text text = tiff->pages.at[0].description;
    const size_t pages = tiff->pages.count;
    if (!text_starts(text, "ImageJ=")) {
        return;
    }
    while (text.size && text.data[text.size - 1] == '\0') {
        text.size--;
    }
    const uint64_t images = imagej_number(job, text, "images", pages);
    const uint64_t slices = imagej_number(job, text, "slices", 1);
    const uint64_t channels = imagej_number(job, text, "channels", 1);
    const uint64_t frames = imagej_number(job, text, "frames", 1);
    if ((slices > 1) + (channels > 1) + (frames > 1) > 1) { /* one at most: other words for a stack */
        job_refuse(job,
                   "ImageDescription: found %llu slices, %llu channels and %llu frames, allowed is one of them above 1",
                   (unsigned long long)slices, (unsigned long long)channels, (unsigned long long)frames);
    }
    if (!job_ok(job) || pages == images) {
        return;
    }
    bool fits = pages == 1 && tiff->whole && images <= tiff->file.size / tiff->page_bytes &&
                tiff_has(&tiff->file, tiff->start, images * tiff->page_bytes);
    if (!fits) {
        job_bad(job, "ImageDescription: ImageJ says images=%llu, the file has %zu pages%s", (unsigned long long)images,
                pages, pages == 1 ? " and too few bytes behind its first" : "");
    }
    tiff->depth = images;
}

void tiff_parse(struct job *job, struct tiff *out, const uint8_t *data, size_t size)
{
    *out = (struct tiff){.file = {.data = data, .size = size}};
    read_pages(job, out, read_header(job, &out->file));
    if (job_ok(job)) {
        check_pages(job, out);
        out->depth = out->pages.count;
    }
    if (job_ok(job)) {
        read_imagej(job, out);
    }
}

/* Copies what of an unpacked tile lies on the page. */
static void place_tile(uint8_t *page_out, const struct tiff_page *page, uint64_t index, const uint8_t *tile)
{
    size_t pixel = page->bits / 8;
    uint64_t left = index % page->across * page->chunk_width;
    uint64_t top = index / page->across * page->chunk_length;
    uint64_t columns = page->width - left < page->chunk_width ? page->width - left : page->chunk_width;
    uint64_t rows = page->length - top < page->chunk_length ? page->length - top : page->chunk_length;
    for (uint64_t row = 0; row < rows; row++) {
        memcpy(page_out + ((top + row) * page->width + left) * pixel, tile + row * page->chunk_width * pixel,
               columns * pixel);
    }
}

/* Without a message: CONUS_ERROR_DATA where the packed bytes of *chunk are damaged, CONUS_ERROR_MEMORY. */
static conus_status unpack_page(uint8_t *out, uint64_t *chunk, const struct tiff *tiff, const struct tiff_page *page,
                                struct tiff_unpacker *unpacker)
{
    conus_status status = CONUS_OK;
    size_t row_bytes = page->width * (page->bits / 8);
    uint8_t *tile = page->tiled ? memory_raw(chunk_bytes(page, 0), 1) : NULL;
    if (page->tiled && !tile) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint64_t i = 0; !status && i < page->across * page->down; i++) {
        const struct tiff_chunk packed = {
            .packed = tiff->file.data + tiff_list_at(&tiff->file, &page->offsets, i),
            .packed_size = tiff_list_at(&tiff->file, &page->counts, i),
            .out = tile ? tile : out + i * page->chunk_length * row_bytes,
            .width = page->chunk_width,
            .rows = stored_rows(page, i),
        };
        status = tiff_chunk_unpack(unpacker, page, &packed, tiff->file.swapped);
        *chunk = i;
        if (!status && tile) {
            place_tile(out, page, i, tile);
        }
    }
    memory_free(tile);
    return status;
}

/* Pages that threads unpack, each a block of them. */
struct unpacking {
    const struct tiff *tiff;
    uint8_t *out;
    size_t first, count, pieces;
    size_t next[THREADS_MOST]; /* page of each block; its end where none has failed */
};

static size_t block_begin(const struct unpacking *unpacking, size_t piece)
{
    return unpacking->first + threads_begin(piece, unpacking->pieces, unpacking->count, 1);
}

/* Unpacks what is left of a block, up to the first page that fails, and its *chunk. */
static conus_status unpack_block(struct unpacking *unpacking, size_t piece, uint64_t *chunk)
{
    const struct tiff *tiff = unpacking->tiff;
    struct tiff_unpacker unpacker = {0};
    conus_status status = CONUS_OK;
    for (size_t *page = &unpacking->next[piece], end = block_begin(unpacking, piece + 1); !status && *page < end;) {
        uint8_t *out = unpacking->out + (*page - unpacking->first) * tiff->page_bytes;
        status = unpack_page(out, chunk, tiff, &tiff->pages.at[*page], &unpacker);
        *page += !status;
    }
    libdeflate_free_decompressor(unpacker.deflate);
    memory_free(unpacker.lzw);
    return status;
}

static void unpack_piece(void *user, size_t piece)
{
    uint64_t chunk;
    (void)unpack_block(user, piece, &chunk); /* a page that fails does so again, on the caller's thread */
}

void tiff_unpack(struct job *job, uint8_t *out, const struct tiff *tiff, size_t first, size_t count)
{
    enum { LEAST_BYTES = 1 << 20 };
    struct unpacking unpacking = {.tiff = tiff, .out = out, .first = first, .count = count};
    unpacking.pieces = threads_for(count, LEAST_BYTES / (tiff->page_bytes + 1) + 1);
    for (size_t i = 0; i < unpacking.pieces; i++) {
        unpacking.next[i] = block_begin(&unpacking, i);
    }
    if (unpacking.pieces > 1) {
        threads_run(unpack_piece, &unpacking, unpacking.pieces);
    }
    for (size_t i = 0; job_step(job) && i < unpacking.pieces; i++) {
        uint64_t chunk = 0;
        const conus_status status = unpack_block(&unpacking, i, &chunk);
        const size_t place = job_in(job, "page ", unpacking.next[i]);
        if (status == CONUS_ERROR_DATA) {
            job_bad(job, "%s %llu: damaged, or not as long as its pixels",
                    tiff->pages.at[unpacking.next[i]].tiled ? "tile" : "strip", (unsigned long long)chunk);
        } else if (status) {
            job_fail(job, status, "not enough memory to unpack");
        }
        job_out(job, place);
    }
}
