/* SPDX-License-Identifier: BSD-3-Clause */
/* Follows the chain of directories, checks that the pages make a stack that the file can hold, and unpacks it. */
#include "loaders/tiff/tiff.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/tiff/tiff_chunk.h"

#include <stdio.h>
#include <string.h>

bool tiff_is(const uint8_t *data, size_t size)
{
    static const char *const magics[] = {"II*\0", "MM\0*", "II+\0", "MM\0+"};
    for (size_t i = 0; size >= 4 && i < sizeof magics / sizeof magics[0]; i++) {
        if (memcmp(data, magics[i], 4) == 0) {
            return true;
        }
    }
    return false;
}

void tiff_finish(struct tiff *tiff)
{
    memory_free(tiff->pages);
    *tiff = (struct tiff){0};
}

/* Puts "page K: " in front of the message. */
static conus_status fail_page(conus_status status, size_t page)
{
    char where[32];
    snprintf(where, sizeof where, "page %zu", page);
    return fail_in(status, where);
}

static conus_status read_header(struct tiff_file *file, uint64_t *first)
{
    if (!tiff_is(file->data, file->size)) {
        return fail(CONUS_ERROR_DATA, "magic: no TIFF file");
    }
    bool big_endian = file->data[0] == 'M';
    file->swapped = big_endian == BIG_ENDIAN_IS_SWAPPED;
    file->big = file->data[big_endian ? 3 : 2] == '+';
    if (!tiff_has(file, 0, file->big ? 16 : 8)) {
        return fail(CONUS_ERROR_DATA, "header: found %zu bytes, TIFF needs %d", file->size, file->big ? 16 : 8);
    }
    if (file->big && (tiff_number(file, 4, 2) != 8 || tiff_number(file, 6, 2) != 0)) {
        return fail(CONUS_ERROR_DATA, "header: found offsets of %u bytes, BigTIFF has 8",
                    (unsigned)tiff_number(file, 4, 2));
    }
    *first = file->big ? tiff_number(file, 8, 8) : tiff_number(file, 4, 4);
    return *first ? CONUS_OK : fail(CONUS_ERROR_DATA, "header: there is no directory");
}

static conus_status compare_pages(const struct tiff_page *a, const struct tiff_page *b)
{
    return a->width == b->width && a->length == b->length && a->bits == b->bits && a->format == b->format
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "%llu x %llu pixels of %u bits, SampleFormat %d, but page 0 has %llu x %llu of %u bits, "
                      "SampleFormat %d: all must be alike",
                      (unsigned long long)b->width, (unsigned long long)b->length, b->bits, (int)b->format,
                      (unsigned long long)a->width, (unsigned long long)a->length, a->bits, (int)a->format);
}

/* Stops at a directory that comes again: `seen` is one of those before, moved on at 1, 2, 4, ... pages (Brent). */
static conus_status read_pages(struct tiff *tiff, uint64_t at)
{
    uint64_t seen = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && at; i++) {
        if (at == seen) {
            return fail(CONUS_ERROR_DATA, "directory: that at byte %llu follows on itself", (unsigned long long)at);
        }
        if (i == TIFF_PAGE_LIMIT) {
            return fail(CONUS_ERROR_UNSUPPORTED, "directory: more than %d pages", TIFF_PAGE_LIMIT);
        }
        seen = (i & (i - 1)) == 0 ? at : seen;
        if (!memory_reserve(&tiff->pages, &tiff->page_capacity, i + 1, sizeof *tiff->pages)) {
            return CONUS_ERROR_MEMORY;
        }
        status = tiff_directory_read(&tiff->pages[i], &at, &tiff->file, at);
        status = status ? status : compare_pages(&tiff->pages[0], &tiff->pages[i]);
        status = status ? fail_page(status, i) : CONUS_OK;
        tiff->page_count = status ? i : i + 1;
    }
    return status;
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

/* Packed bytes below this many times fewer can not hold a chunk: of deflate, a match of 258 bytes takes 2 bits; of LZW,
 * the longest string that 4096 codes can make takes 9 bits or more. */
static uint64_t largest_ratio(enum tiff_compression compression)
{
    return compression == TIFF_PLAIN ? 1 : compression == TIFF_LZW ? 4096 : 1032;
}

static conus_status check_chunk(const struct tiff *tiff, const struct tiff_page *page, uint64_t index)
{
    uint64_t at = tiff_list_at(&tiff->file, &page->offsets, index);
    uint64_t count = tiff_list_at(&tiff->file, &page->counts, index);
    uint64_t wanted = chunk_bytes(page, index);
    const char *words = page->tiled ? "tile" : "strip";
    if (!at || !count || !tiff_has(&tiff->file, at, count)) {
        return fail(CONUS_ERROR_DATA, "%s %llu: %llu bytes at byte %llu, the file has %zu bytes", words,
                    (unsigned long long)index, (unsigned long long)count, (unsigned long long)at, tiff->file.size);
    }
    bool plain = page->compression == TIFF_PLAIN;
    return (plain ? count == wanted : wanted / largest_ratio(page->compression) <= count)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s %llu: %llu bytes, its %llu x %llu pixels of %u bits are %llu%s", words,
                      (unsigned long long)index, (unsigned long long)count, (unsigned long long)page->chunk_width,
                      (unsigned long long)stored_rows(page, index), page->bits, (unsigned long long)wanted,
                      plain ? "" : " unpacked, which so few cannot hold");
}

/* Checks the chunks of a page; `total` grows by their stored bytes, `end` is where the one before ended. */
static conus_status check_page(struct tiff *tiff, const struct tiff_page *page, uint64_t *total, uint64_t *end)
{
    conus_status status = CONUS_OK;
    tiff->whole = tiff->whole && page->compression == TIFF_PLAIN && !page->tiled;
    for (uint64_t i = 0; !status && i < page->across * page->down; i++) {
        status = check_chunk(tiff, page, i);
        if (status) {
            break;
        }
        uint64_t at = tiff_list_at(&tiff->file, &page->offsets, i);
        uint64_t count = tiff_list_at(&tiff->file, &page->counts, i);
        tiff->start = *end ? tiff->start : at;
        tiff->whole = tiff->whole && (!*end || at == *end);
        *end = at + count;
        *total += count;
        if (*total > tiff->file.size) {
            status = fail(CONUS_ERROR_DATA, "%s: those up to here have more bytes together than the file: they overlap",
                          page->tiled ? "TileByteCounts" : "StripByteCounts");
        }
    }
    return status;
}

static conus_status check_pages(struct tiff *tiff)
{
    const struct tiff_page *first = &tiff->pages[0];
    uint64_t total = 0;
    uint64_t end = 0;
    uint64_t pixels = first->width * first->length; /* each below 2^31 */
    conus_status status = CONUS_OK;
    if (pixels > (UINT64_C(1) << 62) / TIFF_PAGE_LIMIT / 8) {
        return fail(CONUS_ERROR_DATA, "ImageWidth: %llu x %llu pixels, more than any file can hold",
                    (unsigned long long)first->width, (unsigned long long)first->length);
    }
    tiff->page_bytes = pixels * (first->bits / 8);
    tiff->whole = true;
    for (size_t i = 0; !status && i < tiff->page_count; i++) {
        status = check_page(tiff, &tiff->pages[i], &total, &end);
        status = status ? fail_page(status, i) : CONUS_OK;
    }
    return status;
}

/* The number behind "key=" at the start of a line of ImageJ's description; `absent` where there is none. */
static conus_status imagej_number(uint64_t *out, struct text text, const char *key, uint64_t absent)
{
    struct text line;
    *out = absent;
    while (text_line(&text, &line)) {
        size_t length = strlen(key);
        if (text_starts(line, key) && line.size > length && line.data[length] == '=') {
            struct text value = {line.data + length + 1, line.size - length - 1};
            return text_to_uint(text_trim(value), UINT32_MAX, out) && *out
                       ? CONUS_OK
                       : fail(CONUS_ERROR_DATA, "ImageDescription: %s: a whole number above 0 is needed", key);
        }
    }
    return CONUS_OK;
}

static conus_status check_imagej(struct tiff *tiff, uint64_t images)
{
    if (tiff->page_count == images) {
        return CONUS_OK;
    }
    bool fits = tiff->page_count == 1 && tiff->whole && images <= tiff->file.size / tiff->page_bytes &&
                tiff_has(&tiff->file, tiff->start, images * tiff->page_bytes);
    if (!fits) {
        return fail(CONUS_ERROR_DATA, "ImageDescription: ImageJ says images=%llu, the file has %zu pages%s",
                    (unsigned long long)images, tiff->page_count,
                    tiff->page_count == 1 ? " and too few bytes behind its first" : "");
    }
    tiff->depth = images;
    return CONUS_OK;
}

/* ImageJ describes stacks in its own words; those above 4 GB have one directory, and the pages behind each other. */
static conus_status read_imagej(struct tiff *tiff)
{
    static const char *const keys[] = {"slices", "channels", "frames"};
    struct text text = tiff->pages[0].description;
    uint64_t images = 0;
    uint64_t counts[3] = {0};
    if (!text_starts(text, "ImageJ=")) {
        return CONUS_OK;
    }
    while (text.size && text.data[text.size - 1] == '\0') {
        text.size--;
    }
    conus_status status = imagej_number(&images, text, "images", tiff->page_count);
    for (size_t i = 0; !status && i < 3; i++) {
        status = imagej_number(&counts[i], text, keys[i], 1);
    }
    if (!status && (counts[0] > 1) + (counts[1] > 1) + (counts[2] > 1) > 1) { /* one of them: other words for a stack */
        status =
            fail(CONUS_ERROR_UNSUPPORTED,
                 "ImageDescription: found %llu slices, %llu channels and %llu frames, allowed is one of them above 1",
                 (unsigned long long)counts[0], (unsigned long long)counts[1], (unsigned long long)counts[2]);
    }
    return status ? status : check_imagej(tiff, images);
}

conus_status tiff_parse(struct tiff *out, const uint8_t *data, size_t size)
{
    struct tiff tiff = {.file = {.data = data, .size = size}};
    uint64_t first = 0;
    conus_status status = read_header(&tiff.file, &first);
    status = status ? status : read_pages(&tiff, first);
    status = status ? status : check_pages(&tiff);
    tiff.depth = tiff.page_count;
    status = status ? status : read_imagej(&tiff);
    if (status) {
        tiff_finish(&tiff);
        return status;
    }
    *out = tiff;
    return CONUS_OK;
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

static conus_status unpack_page(uint8_t *out, const struct tiff *tiff, const struct tiff_page *page,
                                struct tiff_unpacker *unpacker)
{
    conus_status status = CONUS_OK;
    size_t row_bytes = page->width * (page->bits / 8);
    uint8_t *tile = page->tiled ? memory_raw(chunk_bytes(page, 0), 1) : NULL;
    if (page->tiled && !tile) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint64_t i = 0; !status && i < page->across * page->down; i++) {
        const struct tiff_chunk chunk = {
            .packed = tiff->file.data + tiff_list_at(&tiff->file, &page->offsets, i),
            .packed_size = tiff_list_at(&tiff->file, &page->counts, i),
            .out = tile ? tile : out + i * page->chunk_length * row_bytes,
            .width = page->chunk_width,
            .rows = stored_rows(page, i),
        };
        status = tiff_chunk_unpack(unpacker, page, &chunk, tiff->file.swapped);
        if (!status && tile) {
            place_tile(out, page, i, tile);
        }
        if (status == CONUS_ERROR_DATA) {
            status = fail(status, "%s %llu: damaged, or not as long as its pixels", tile ? "tile" : "strip",
                          (unsigned long long)i);
        }
    }
    memory_free(tile);
    return status;
}

conus_status tiff_unpack(struct bytes *out, const struct tiff *tiff)
{
    struct tiff_unpacker unpacker = {0};
    size_t size = tiff->depth * tiff->page_bytes; /* counted when the file was parsed */
    uint8_t *data = memory_raw(size, 1);
    conus_status status = data ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && tiff->whole) {
        memcpy(data, tiff->file.data + tiff->start, size);
    }
    for (size_t i = 0; !status && !tiff->whole && i < tiff->page_count; i++) {
        status = unpack_page(data + i * tiff->page_bytes, tiff, &tiff->pages[i], &unpacker);
        status = status ? fail_page(status, i) : CONUS_OK;
    }
    tiff_unpacker_finish(&unpacker);
    if (status) {
        memory_free(data);
        return status;
    }
    *out = (struct bytes){data, size};
    return CONUS_OK;
}
