/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a directory by a table of the fields that matter, and refuses what is no page of one number a pixel. */
#include "loaders/tiff/tiff_directory.h"

#include "base/byte_order.h"

enum field {
    SUBFILE,
    WIDTH,
    LENGTH,
    BITS,
    COMPRESSION,
    PHOTOMETRIC,
    FILL_ORDER,
    DESCRIPTION,
    STRIP_OFFSETS,
    ORIENTATION,
    SAMPLES,
    STRIP_ROWS,
    STRIP_COUNTS,
    PLANAR,
    PREDICTOR,
    TILE_WIDTH,
    TILE_LENGTH,
    TILE_OFFSETS,
    TILE_COUNTS,
    FORMAT,
    DEPTH,
    TILE_DEPTH,
    FIELD_COUNT
};

/* TIFF 6.0, and SGI's two fields of depth. */
static const struct {
    uint16_t tag;
    const char *name;
} fields[FIELD_COUNT] = {
    [SUBFILE] = {254, "NewSubfileType"},       [WIDTH] = {256, "ImageWidth"},
    [LENGTH] = {257, "ImageLength"},           [BITS] = {258, "BitsPerSample"},
    [COMPRESSION] = {259, "Compression"},      [PHOTOMETRIC] = {262, "PhotometricInterpretation"},
    [FILL_ORDER] = {266, "FillOrder"},         [DESCRIPTION] = {270, "ImageDescription"},
    [STRIP_OFFSETS] = {273, "StripOffsets"},   [ORIENTATION] = {274, "Orientation"},
    [SAMPLES] = {277, "SamplesPerPixel"},      [STRIP_ROWS] = {278, "RowsPerStrip"},
    [STRIP_COUNTS] = {279, "StripByteCounts"}, [PLANAR] = {284, "PlanarConfiguration"},
    [PREDICTOR] = {317, "Predictor"},          [TILE_WIDTH] = {322, "TileWidth"},
    [TILE_LENGTH] = {323, "TileLength"},       [TILE_OFFSETS] = {324, "TileOffsets"},
    [TILE_COUNTS] = {325, "TileByteCounts"},   [FORMAT] = {339, "SampleFormat"},
    [DEPTH] = {32997, "ImageDepth"},           [TILE_DEPTH] = {32998, "TileDepth"},
};

enum { SIDE_LIMIT = INT32_MAX, TILE_LIMIT = 1 << 28 /* bytes of a tile, unpacked */ };

/* A directory while it is read. */
struct directory {
    const struct tiff_file *file;
    struct tiff_list lists[FIELD_COUNT];
};

bool tiff_has(const struct tiff_file *file, uint64_t at, uint64_t size)
{
    return at <= file->size && size <= file->size - at;
}

uint64_t tiff_number(const struct tiff_file *file, uint64_t at, size_t size)
{
    const uint8_t *data = file->data + at;
    return size == 8   ? order_u64(data, file->swapped)
           : size == 4 ? order_u32(data, file->swapped)
           : size == 2 ? order_u16(data, file->swapped)
                       : *data;
}

uint64_t tiff_list_at(const struct tiff_file *file, const struct tiff_list *list, uint64_t index)
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

static conus_status read_value(struct directory *directory, enum field field, uint64_t at)
{
    const struct tiff_file *file = directory->file;
    size_t width = file->big ? 8 : 4; /* of the count, and of what is stored in the entry itself */
    uint64_t type = tiff_number(file, at + 2, 2);
    uint64_t count = tiff_number(file, at + 4, width);
    uint64_t value = at + 4 + width;
    struct tiff_list *list = &directory->lists[field];
    size_t size = type_size(field, type);
    if (list->count) {
        return fail(CONUS_ERROR_DATA, "%s: is there twice", fields[field].name);
    }
    if (!size || !count) {
        return fail(CONUS_ERROR_DATA, "%s: found %llu values of type %llu, %s is needed", fields[field].name,
                    (unsigned long long)count, (unsigned long long)type,
                    field == DESCRIPTION ? "a text" : "a whole number (types 1, 3, 4, 16)");
    }
    value = count > width / size ? tiff_number(file, value, width) : value;
    if (count > file->size / size || !tiff_has(file, value, count * size)) {
        return fail(CONUS_ERROR_DATA, "%s: %llu values at byte %llu, the file has %zu bytes", fields[field].name,
                    (unsigned long long)count, (unsigned long long)value, file->size);
    }
    *list = (struct tiff_list){value, count, size};
    return CONUS_OK;
}

static conus_status read_entries(struct directory *directory, uint64_t *next, uint64_t at)
{
    const struct tiff_file *file = directory->file;
    size_t head = file->big ? 8 : 2;
    size_t entry = file->big ? 20 : 12;
    size_t tail = file->big ? 8 : 4;
    uint64_t count = tiff_has(file, at, head) ? tiff_number(file, at, head) : 0;
    if (!count || count > UINT16_MAX || !tiff_has(file, at, head + count * entry + tail)) {
        return fail(CONUS_ERROR_DATA, "directory: %llu entries at byte %llu, the file has %zu bytes",
                    (unsigned long long)count, (unsigned long long)at, file->size);
    }
    conus_status status = CONUS_OK;
    for (uint64_t i = 0; !status && i < count; i++) {
        uint64_t start = at + head + i * entry;
        uint64_t tag = tiff_number(file, start, 2);
        for (int field = 0; !status && field < FIELD_COUNT; field++) {
            status = fields[field].tag == tag ? read_value(directory, (enum field)field, start) : CONUS_OK;
        }
    }
    *next = tiff_number(file, at + head + count * entry, tail);
    return status;
}

/* The one number of a field, or `absent` where it is not there. */
static conus_status read_one(uint64_t *out, const struct directory *directory, enum field field, uint64_t absent)
{
    const struct tiff_list *list = &directory->lists[field];
    if (list->count > 1) {
        return fail(CONUS_ERROR_DATA, "%s: found %llu numbers, one is needed", fields[field].name,
                    (unsigned long long)list->count);
    }
    *out = list->count ? tiff_list_at(directory->file, list, 0) : absent;
    return CONUS_OK;
}

static conus_status read_side(uint64_t *out, const struct directory *directory, enum field field)
{
    conus_status status = read_one(out, directory, field, 0);
    if (!status && !directory->lists[field].count) {
        return fail(CONUS_ERROR_DATA, "%s: is missing", fields[field].name);
    }
    return status || (*out >= 1 && *out <= SIDE_LIMIT)
               ? status
               : fail(CONUS_ERROR_DATA, "%s: found %llu, allowed are 1 to 2147483647", fields[field].name,
                      (unsigned long long)*out);
}

/* Fields that have one meaning here. */
static conus_status check_plain_fields(const struct directory *directory)
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
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < sizeof checks / sizeof checks[0]; i++) {
        uint64_t value = 0;
        status = read_one(&value, directory, checks[i].field, checks[i].absent);
        if (!status && value != checks[i].first && value != checks[i].second) {
            status = fail(CONUS_ERROR_UNSUPPORTED, "%s: found %llu, allowed is %s", fields[checks[i].field].name,
                          (unsigned long long)value, checks[i].allowed);
        }
    }
    return status;
}

static conus_status read_pixel(struct tiff_page *page, const struct directory *directory)
{
    uint64_t bits = 0;
    uint64_t format = 0;
    conus_status status = read_one(&bits, directory, BITS, 1);
    status = status ? status : read_one(&format, directory, FORMAT, TIFF_UNSIGNED);
    bool whole = bits == 8 || bits == 16 || bits == 32 || bits == 64;
    bool known = whole && format >= TIFF_UNSIGNED && format <= TIFF_FLOAT && (format != TIFF_FLOAT || bits >= 32);
    if (!status && !known) {
        return fail(
            CONUS_ERROR_UNSUPPORTED,
            "BitsPerSample: found %llu of SampleFormat %llu, allowed are 8, 16, 32 and 64 of 1 (unsigned) and 2 "
            "(signed), 32 and 64 of 3 (float)",
            (unsigned long long)bits, (unsigned long long)format);
    }
    page->bits = (unsigned)bits;
    page->format = (enum tiff_format)format;
    return status;
}

static conus_status read_compression(struct tiff_page *page, const struct directory *directory)
{
    enum { OLD_DEFLATE = 32946 };
    uint64_t method = 0;
    uint64_t predictor = 0;
    conus_status status = read_one(&method, directory, COMPRESSION, TIFF_PLAIN);
    status = status ? status : read_one(&predictor, directory, PREDICTOR, 1);
    method = method == OLD_DEFLATE ? TIFF_DEFLATE : method;
    if (!status && method != TIFF_PLAIN && method != TIFF_LZW && method != TIFF_DEFLATE) {
        return fail(CONUS_ERROR_UNSUPPORTED, "Compression: found %llu, allowed are 1 (none), 5 (LZW) and 8 (deflate)",
                    (unsigned long long)method);
    }
    if (!status && (predictor < 1 || predictor > (method == TIFF_PLAIN ? 1 : 2))) {
        return fail(CONUS_ERROR_UNSUPPORTED, "Predictor: found %llu, allowed are 1 and, of LZW and deflate, 2",
                    (unsigned long long)predictor);
    }
    page->compression = (enum tiff_compression)method;
    page->differences = predictor == 2;
    return status;
}

static conus_status read_tiles(struct tiff_page *page, const struct directory *directory)
{
    conus_status status = read_side(&page->chunk_width, directory, TILE_WIDTH);
    status = status ? status : read_side(&page->chunk_length, directory, TILE_LENGTH);
    if (!status && page->chunk_width > TILE_LIMIT / (page->bits / 8) / page->chunk_length) {
        status =
            fail(CONUS_ERROR_UNSUPPORTED, "TileWidth: %llu x %llu pixels of %u bits, allowed are %d bytes a tile",
                 (unsigned long long)page->chunk_width, (unsigned long long)page->chunk_length, page->bits, TILE_LIMIT);
    }
    page->offsets = directory->lists[TILE_OFFSETS];
    page->counts = directory->lists[TILE_COUNTS];
    return status;
}

static conus_status read_strips(struct tiff_page *page, const struct directory *directory)
{
    uint64_t rows = 0;
    conus_status status = read_one(&rows, directory, STRIP_ROWS, page->length);
    if (!status && !rows) {
        status = fail(CONUS_ERROR_DATA, "RowsPerStrip: found 0, allowed is 1 or more");
    }
    page->chunk_width = page->width;
    page->chunk_length = rows < page->length ? rows : page->length;
    page->offsets = directory->lists[STRIP_OFFSETS];
    page->counts = directory->lists[STRIP_COUNTS];
    return status;
}

static conus_status read_chunks(struct tiff_page *page, const struct directory *directory)
{
    static const enum field tile_fields[] = {TILE_WIDTH, TILE_LENGTH, TILE_OFFSETS, TILE_COUNTS};
    for (size_t i = 0; i < sizeof tile_fields / sizeof tile_fields[0]; i++) {
        page->tiled = page->tiled || directory->lists[tile_fields[i]].count;
    }
    if (page->tiled && (directory->lists[STRIP_OFFSETS].count || directory->lists[STRIP_COUNTS].count)) {
        return fail(CONUS_ERROR_DATA, "StripOffsets: the page has tiles as well, one of them is allowed");
    }
    conus_status status = page->tiled ? read_tiles(page, directory) : read_strips(page, directory);
    if (status) {
        return status;
    }
    page->across = (page->width + page->chunk_width - 1) / page->chunk_width;
    page->down = (page->length + page->chunk_length - 1) / page->chunk_length;
    uint64_t wanted = page->across * page->down; /* each below 2^31 */
    const struct tiff_list *lists[] = {&page->offsets, &page->counts};
    for (size_t i = 0; i < 2; i++) {
        if (lists[i]->count != wanted) {
            return fail(CONUS_ERROR_DATA, "%s: found %llu numbers, the page has %llu %s",
                        fields[page->tiled ? TILE_OFFSETS + i
                               : i         ? STRIP_COUNTS
                                           : STRIP_OFFSETS]
                            .name,
                        (unsigned long long)lists[i]->count, (unsigned long long)wanted,
                        page->tiled ? "tiles" : "strips");
        }
    }
    return CONUS_OK;
}

conus_status tiff_directory_read(struct tiff_page *out, uint64_t *next, const struct tiff_file *file, uint64_t at)
{
    struct directory directory = {.file = file};
    struct tiff_page page = {0};
    conus_status status = read_entries(&directory, next, at);
    status = status ? status : check_plain_fields(&directory);
    status = status ? status : read_side(&page.width, &directory, WIDTH);
    status = status ? status : read_side(&page.length, &directory, LENGTH);
    status = status ? status : read_pixel(&page, &directory);
    status = status ? status : read_compression(&page, &directory);
    status = status ? status : read_chunks(&page, &directory);
    if (status) {
        return status;
    }
    const struct tiff_list *text = &directory.lists[DESCRIPTION];
    page.description = (struct text){(const char *)file->data + text->at, text->count};
    *out = page;
    return CONUS_OK;
}
