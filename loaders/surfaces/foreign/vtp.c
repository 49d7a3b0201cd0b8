/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses VTK's XML format: polygons, then strips, of each piece; for who wants them lines, and numbers of points and
 * cells. */
#include "base/buffer.h"
#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/base64.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"
#include "loaders/surfaces/foreign/words.h"

#include <libdeflate.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum vtp_kind { VTP_INTEGER, VTP_UNSIGNED, VTP_REAL };

/* How an array is stored. */
struct vtp_storage {
    enum vtp_kind kind;
    size_t size;         /* Bytes of a number: 1, 2, 4 or 8.                  */
    bool is_text;        /* Else binary, ...                                  */
    bool is_raw;         /* ... as it is, or in base64.                       */
    bool is_packed;      /* Blocks of zlib.                                   */
    bool swapped;        /* Not this machine's byte order.                    */
    size_t header;       /* Bytes of a number of the header: 4 or 8.          */
    uint64_t max_memory; /* Bytes that the unpacked numbers may take.         */
    bool any;            /* NaN and infinity are numbers, too, where they are text. */
    struct text content; /* The numbers; appended ones with whatever follows. */
};

enum { INFLATE_RATIO = 1032 }; /* the most that deflate makes of a byte */

/* Bytes out of a file that may hold them in base64. */

struct source {
    struct text rest;
    bool is_raw;
    uint8_t group[3]; /* decoded and not taken */
    size_t waiting;   /* bytes of it */
};

/* The next four digits; padding ends a part, behind which another one begins. False where there are none. */
static bool decode_group(struct source *source)
{
    uint32_t bits = 0;
    size_t digits = 0;
    size_t padding = 0;
    while (digits < 4 && source->rest.size) {
        char c = *source->rest.data;
        source->rest = (struct text){source->rest.data + 1, source->rest.size - 1};
        if (c == ' ' || (c >= '\t' && c <= '\r')) {
            continue;
        }
        bool pad = c == '=' && digits >= 2;
        if (pad ? false : base64_value(c) < 0 || padding) {
            return false;
        }
        padding += pad;
        bits = bits << 6 | (pad ? 0 : (uint32_t)base64_value(c));
        digits++;
    }
    source->waiting = digits == 4 ? 3 - padding : 0;
    for (size_t i = 0; i < source->waiting; i++) { /* the last of them first, to be taken from the end */
        source->group[source->waiting - 1 - i] = (uint8_t)(bits >> (16 - 8 * i));
    }
    return digits == 4;
}

static bool vtp_take_bytes(uint8_t *out, struct source *source, size_t size)
{
    if (source->is_raw) {
        if (size > source->rest.size) {
            return false;
        }
        memcpy(out, source->rest.data, size);
        source->rest = (struct text){source->rest.data + size, source->rest.size - size};
        return true;
    }
    for (size_t i = 0; i < size; i++) {
        if (!source->waiting && !decode_group(source)) {
            return false;
        }
        out[i] = source->group[--source->waiting];
    }
    return true;
}

/* Bytes that the source holds at most. */
static size_t bytes_left(const struct source *source)
{
    return source->is_raw ? source->rest.size : source->rest.size / 4 * 3 + 3;
}

static bool take_header(uint64_t *out, struct source *source, const struct vtp_storage *storage)
{
    uint8_t bytes[8];
    if (!vtp_take_bytes(bytes, source, storage->header)) {
        return false;
    }
    *out = storage->header == 4 ? order_u32(bytes, storage->swapped) : order_u64(bytes, storage->swapped);
    return true;
}

static conus_status vtp_fail_cut_off(void)
{
    return fail(CONUS_ERROR_DATA, "DataArray: its data are cut off, or no base64");
}

/* The size, then the bytes. */
static conus_status read_plain(struct bytes *out, struct source *source, const struct vtp_storage *storage)
{
    uint64_t size;
    if (!take_header(&size, source, storage) || size > bytes_left(source)) {
        return vtp_fail_cut_off();
    }
    struct bytes bytes = {memory_raw((size_t)size, 1), (size_t)size};
    if (!bytes.data) {
        return CONUS_ERROR_MEMORY;
    }
    if (!vtp_take_bytes(bytes.data, source, bytes.size)) {
        bytes_finish(&bytes);
        return vtp_fail_cut_off();
    }
    *out = bytes;
    return CONUS_OK;
}

/* All blocks have `size` bytes, unpacked, but the last one if `last` is not 0. */
struct blocks {
    uint64_t count, size, last;
    uint64_t *packed; /* [count] their sizes, packed; owned */
};

static conus_status read_block_sizes(struct blocks *out, struct source *source, const struct vtp_storage *storage)
{
    bool there = take_header(&out->count, source, storage);
    if (there && !out->count) {
        return CONUS_OK;
    }
    if (!there || !take_header(&out->size, source, storage) || !take_header(&out->last, source, storage) ||
        out->count > bytes_left(source) / storage->header) {
        return vtp_fail_cut_off();
    }
    if (out->last > out->size) {
        return fail(CONUS_ERROR_DATA, "DataArray: a last block of %llu bytes, the others have %llu",
                    (unsigned long long)out->last, (unsigned long long)out->size);
    }
    out->packed = memory_zeroed((size_t)out->count, sizeof *out->packed);
    if (!out->packed) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint64_t i = 0; i < out->count; i++) {
        if (!take_header(&out->packed[i], source, storage)) {
            return vtp_fail_cut_off();
        }
    }
    return CONUS_OK;
}

static uint64_t size_of_block(const struct blocks *blocks, uint64_t i)
{
    return i + 1 == blocks->count && blocks->last ? blocks->last : blocks->size;
}

/* The unpacked size of all blocks; refused where the packed bytes are too few for it. */
static conus_status find_size(size_t *out, const struct blocks *blocks, const struct source *source,
                              const struct vtp_storage *storage)
{
    uint64_t all = 0;
    uint64_t packed = 0;
    for (uint64_t i = 0; i < blocks->count; i++) {
        uint64_t size = size_of_block(blocks, i);
        if (blocks->packed[i] > bytes_left(source) || size / INFLATE_RATIO > blocks->packed[i] ||
            __builtin_add_overflow(packed, blocks->packed[i], &packed) || __builtin_add_overflow(all, size, &all)) {
            return fail(CONUS_ERROR_DATA, "DataArray: block %llu has %llu packed bytes for %llu", (unsigned long long)i,
                        (unsigned long long)blocks->packed[i], (unsigned long long)size);
        }
    }
    if (packed > bytes_left(source)) {
        return vtp_fail_cut_off();
    }
    *out = (size_t)all;
    return all <= storage->max_memory
               ? CONUS_OK
               : fail(CONUS_ERROR_MEMORY, "DataArray: %llu bytes, allowed are %llu (--max-memory)",
                      (unsigned long long)all, (unsigned long long)storage->max_memory);
}

static conus_status unpack_block(uint8_t *out, size_t size, struct source *source, size_t packed_size)
{
    struct libdeflate_decompressor *unpacker = libdeflate_alloc_decompressor();
    uint8_t *packed = memory_raw(packed_size, 1);
    size_t got = 0;
    size_t used = 0;
    conus_status status = packed && unpacker ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "no memory to unpack");
    if (!status && !vtp_take_bytes(packed, source, packed_size)) {
        status = vtp_fail_cut_off();
    }
    if (!status && (libdeflate_zlib_decompress_ex(unpacker, packed, packed_size, out, size, &used, &got) ||
                    got != size || used != packed_size)) {
        status = fail(CONUS_ERROR_DATA, "DataArray: a block is damaged, or does not unpack to %zu bytes", size);
    }
    memory_free(packed);
    libdeflate_free_decompressor(unpacker);
    return status;
}

static conus_status unpack_blocks(struct bytes *out, struct source *source, const struct blocks *blocks, size_t size)
{
    struct bytes bytes = {memory_raw(size, 1), size};
    conus_status status = bytes.data ? CONUS_OK : CONUS_ERROR_MEMORY;
    size_t at = 0;
    for (uint64_t i = 0; !status && i < blocks->count; i++) {
        size_t block = (size_t)size_of_block(blocks, i);
        status = unpack_block(bytes.data + at, block, source, (size_t)blocks->packed[i]);
        at += block;
    }
    if (status) {
        bytes_finish(&bytes);
        return status;
    }
    *out = bytes;
    return CONUS_OK;
}

static conus_status read_packed(struct bytes *out, struct source *source, const struct vtp_storage *storage)
{
    struct blocks blocks = {0};
    size_t size = 0;
    conus_status status = read_block_sizes(&blocks, source, storage);
    status = status ? status : find_size(&size, &blocks, source, storage);
    status = status ? status : unpack_blocks(out, source, &blocks, size);
    memory_free(blocks.packed);
    return status;
}

/* Unsigned numbers above 2^63 - 1 become -1. */
static int64_t vtp_whole_at(const uint8_t *data, const struct vtp_storage *storage)
{
    bool is_signed = storage->kind == VTP_INTEGER;
    int64_t value = order_whole(data, storage->size, is_signed, storage->swapped);
    return is_signed || value >= 0 ? value : -1;
}

/* The numbers that an array becomes: 64-bit whole ones, or floats. */
static size_t size_of_number(bool whole)
{
    return whole ? sizeof(int64_t) : sizeof(float);
}

static conus_status numbers_of_text(char *numbers, size_t count, const struct vtp_storage *storage, bool whole)
{
    struct words words = {.rest = storage->content, .line = 1};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < count; i++) {
        void *to = numbers + i * size_of_number(whole);
        status = whole          ? words_whole(to, &words, INT64_MIN, "a whole number")
                 : storage->any ? words_any_float(to, &words, "a number")
                                : words_float(to, &words, "a number");
    }
    return status ? fail_in(status, "DataArray") : CONUS_OK;
}

static void numbers_of_bytes(char *numbers, size_t count, const struct vtp_storage *storage, const uint8_t *data,
                             bool whole)
{
    for (size_t i = 0; i < count; i++, data += storage->size) {
        void *to = numbers + i * size_of_number(whole);
        if (whole) {
            *(int64_t *)to = vtp_whole_at(data, storage);
        } else {
            *(float *)to = storage->kind == VTP_REAL ? (float)order_real(data, storage->size, storage->swapped)
                                                     : (float)vtp_whole_at(data, storage);
        }
    }
}

static conus_status numbers_of(void **out, size_t *count, const struct vtp_storage *storage, bool whole)
{
    struct bytes bytes = {0};
    struct source source = {.rest = storage->content, .is_raw = storage->is_raw};
    size_t n = 0;
    conus_status status = storage->is_text     ? CONUS_OK
                          : storage->is_packed ? read_packed(&bytes, &source, storage)
                                               : read_plain(&bytes, &source, storage);
    if (!status && bytes.size % storage->size) {
        status = fail(CONUS_ERROR_DATA, "DataArray: %zu bytes, each number has %zu", bytes.size, storage->size);
    }
    struct text rest = storage->content;
    for (struct text word; storage->is_text && text_word(&rest, &word);) {
        n++;
    }
    n = storage->is_text ? n : bytes.size / storage->size;
    char *numbers = status ? NULL : memory_raw(n, size_of_number(whole));
    status = status || numbers ? status : CONUS_ERROR_MEMORY;
    if (!status && storage->is_text) {
        status = numbers_of_text(numbers, n, storage, whole);
    } else if (!status) {
        numbers_of_bytes(numbers, n, storage, bytes.data, whole);
    }
    bytes_finish(&bytes);
    if (status) {
        memory_free(numbers);
        return status;
    }
    *out = numbers;
    *count = n;
    return CONUS_OK;
}

/* The whole numbers of an array into *out[*count], the caller's to memory_free(); those above 2^63 - 1 become -1. */
static conus_status vtp_wholes(int64_t **out, size_t *count, const struct vtp_storage *storage)
{
    void *numbers = NULL;
    conus_status status = numbers_of(&numbers, count, storage, true);
    *out = status ? *out : numbers;
    return status;
}

/* Numbers of any kind as float, rounded once. */
static conus_status vtp_floats(float **out, size_t *count, const struct vtp_storage *storage)
{
    void *numbers = NULL;
    conus_status status = numbers_of(&numbers, count, storage, false);
    *out = status ? *out : numbers;
    return status;
}

/* The purpose of an array. */
enum use {
    USE_POINTS,
    USE_LINES,
    USE_LINE_OFFSETS,
    USE_POLYS,
    USE_POLY_OFFSETS,
    USE_STRIPS,
    USE_STRIP_OFFSETS,
    USE_SPACE,
    USE_POINT_DATA, /* this and the next stand for any number of arrays */
    USE_CELL_DATA,
    USE_NOTHING,
    USES = USE_POINT_DATA
};

struct part {
    bool there;
    struct vtp_storage storage;
    struct bytes text; /* the array's own, while the piece is read; owned */
};

/* Numbers of a piece's points or cells. */
struct column {
    struct part part;
    char *name;
    bool per_point;
    uint64_t components;
};

struct vtp {
    struct foreign_mesh *mesh;
    struct text appended; /* behind its underscore */
    bool appended_raw;
    bool packed, swapped;
    size_t header;
    uint64_t max_memory;
    bool has_root;
    enum use place;                                  /* in which element we are: USE_POINTS, USE_POLYS and so on */
    enum use use;                                    /* of the array that is open */
    uint64_t points, vertices, lines, polys, strips; /* that the piece says it has; of cells of single vertices */
    struct part parts[USES];
    struct column *columns; /* [column_count] The last is the one that is open; owned. */
    size_t column_count, column_capacity;
};

static const char appended_tag[] = "<AppendedData";

/* Appended data are no XML: the document in `out` ends where they begin. */
static conus_status split_appended(struct buffer *out, struct vtp *vtp, struct text text)
{
    const char *tag = text_find(text, appended_tag);
    if (!tag) {
        buffer_append(out, text.data, text.size);
        return buffer_status(out);
    }
    const char *end = text.data + text.size;
    const char *close = memchr(tag, '>', (size_t)(end - tag));
    const char *mark = close ? memchr(close, '_', (size_t)(end - close)) : NULL;
    if (!mark || text_trim((struct text){close + 1, (size_t)(mark - close) - 1}).size) {
        return fail(CONUS_ERROR_DATA, "AppendedData: the file is cut off, or no \"_\" begins the data");
    }
    /* raw or base64 data end with the closing tags, so that a file that is cut off is known */
    static const char last[] = "/VTKFile>";
    struct text rest = text_trim((struct text){mark + 1, (size_t)(end - mark) - 1});
    const char *slash = text_last(rest, '/');
    if (!slash || !text_mentions(rest, "</AppendedData>") ||
        !text_equal((struct text){slash, (size_t)(rest.data + rest.size - slash)}, last)) {
        return fail(CONUS_ERROR_DATA, "AppendedData: the file ends before </VTKFile>");
    }
    vtp->appended = (struct text){mark + 1, (size_t)(end - mark) - 1};
    buffer_append(out, text.data, (size_t)(close - text.data));
    buffer_text(out, "/></VTKFile>");
    return buffer_status(out);
}

static conus_status take_root(struct vtp *vtp, const struct xml_event *event)
{
    const char *type = xml_attribute(event, "type");
    const char *order = xml_attribute(event, "byte_order");
    const char *header = xml_attribute(event, "header_type");
    const char *packer = xml_attribute(event, "compressor");
    bool little = !order || strcmp(order, "LittleEndian") == 0;
    if (strcmp(event->name, "VTKFile") != 0 || !type || strcmp(type, "PolyData") != 0) {
        return fail(CONUS_ERROR_UNSUPPORTED, "VTKFile: type is %.60s, only PolyData is a surface or lines",
                    type ? type : "not given");
    }
    if (!little && strcmp(order, "BigEndian") != 0) {
        return fail(CONUS_ERROR_DATA, "VTKFile: byte_order is %.60s, allowed are LittleEndian and BigEndian", order);
    }
    if (header && strcmp(header, "UInt32") != 0 && strcmp(header, "UInt64") != 0) {
        return fail(CONUS_ERROR_DATA, "VTKFile: header_type is %.60s, allowed are UInt32 and UInt64", header);
    }
    if (packer && *packer && strcmp(packer, "vtkZLibDataCompressor") != 0) {
        return fail(CONUS_ERROR_UNSUPPORTED, "VTKFile: compressor is %.60s, only vtkZLibDataCompressor is unpacked",
                    packer);
    }
    vtp->has_root = true;
    vtp->packed = packer && *packer;
    vtp->swapped = little == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    vtp->header = header && strcmp(header, "UInt64") == 0 ? 8 : 4;
    return CONUS_OK;
}

static conus_status take_type(struct vtp_storage *out, const char *type)
{
    static const struct {
        const char *name;
        enum vtp_kind kind;
        size_t size;
    } types[] = {{"Int8", VTP_INTEGER, 1},    {"UInt8", VTP_UNSIGNED, 1},  {"Int16", VTP_INTEGER, 2},
                 {"UInt16", VTP_UNSIGNED, 2}, {"Int32", VTP_INTEGER, 4},   {"UInt32", VTP_UNSIGNED, 4},
                 {"Int64", VTP_INTEGER, 8},   {"UInt64", VTP_UNSIGNED, 8}, {"Float32", VTP_REAL, 4},
                 {"Float64", VTP_REAL, 8},    {"String", VTP_INTEGER, 1}};
    for (size_t i = 0; type && i < sizeof types / sizeof types[0]; i++) {
        if (strcmp(type, types[i].name) == 0) {
            out->kind = types[i].kind;
            out->size = types[i].size;
            return CONUS_OK;
        }
    }
    return fail(CONUS_ERROR_DATA, "DataArray: type is %.60s, one like Int32 or Float32 is needed",
                type ? type : "not given");
}

static conus_status take_appended(struct vtp_storage *out, const struct vtp *vtp, const struct xml_event *event)
{
    const char *value = xml_attribute(event, "offset");
    uint64_t offset = 0;
    if (!vtp->appended.data) {
        return fail(CONUS_ERROR_DATA, "DataArray: its data are appended, and there is no AppendedData");
    }
    if (!value || !text_to_uint(text_from(value), vtp->appended.size, &offset)) {
        return fail(CONUS_ERROR_DATA, "DataArray: offset is %.60s, allowed are 0 to %zu", value ? value : "not given",
                    vtp->appended.size);
    }
    out->content = (struct text){vtp->appended.data + offset, vtp->appended.size - offset};
    return CONUS_OK;
}

static enum use use_of_array(const struct vtp *vtp, const struct xml_event *event)
{
    const char *name = xml_attribute(event, "Name");
    bool corners = name && strcmp(name, "connectivity") == 0;
    bool offsets = name && strcmp(name, "offsets") == 0;
    bool space = name && strcmp(name, "SPACE") == 0;
    switch (vtp->place) {
    case USE_POINTS:
        return USE_POINTS;
    case USE_LINES:
        return !vtp->mesh->lines ? USE_NOTHING : corners ? USE_LINES : offsets ? USE_LINE_OFFSETS : USE_NOTHING;
    case USE_POLYS:
        return corners ? USE_POLYS : offsets ? USE_POLY_OFFSETS : USE_NOTHING;
    case USE_STRIPS:
        return corners ? USE_STRIPS : offsets ? USE_STRIP_OFFSETS : USE_NOTHING;
    case USE_SPACE:
        return space ? USE_SPACE : USE_NOTHING;
    case USE_POINT_DATA:
    case USE_CELL_DATA:
        return vtp->mesh->lines && name ? vtp->place : USE_NOTHING;
    default:
        return USE_NOTHING;
    }
}

/* The part of the array that is open; NULL where it is not read. */
static struct part *open_part(struct vtp *vtp)
{
    return vtp->use < USES          ? &vtp->parts[vtp->use]
           : vtp->use < USE_NOTHING ? &vtp->columns[vtp->column_count - 1].part
                                    : NULL;
}

static conus_status add_column(struct vtp *vtp, const struct xml_event *event)
{
    const char *name = xml_attribute(event, "Name");
    const char *components = xml_attribute(event, "NumberOfComponents");
    struct column column = {.per_point = vtp->use == USE_POINT_DATA, .components = 1};
    if (components && !text_to_uint(text_from(components), UINT64_MAX, &column.components)) {
        return fail(CONUS_ERROR_DATA, "%.60s: NumberOfComponents is %.60s, a whole number is needed", name, components);
    }
    column.name = memory_text(name, strlen(name));
    if (!column.name || vtp->column_count > FOREIGN_ARRAY_LIMIT ||
        !memory_reserve(&vtp->columns, &vtp->column_capacity, vtp->column_count + 1, sizeof column)) {
        bool too_many = column.name && vtp->column_count > FOREIGN_ARRAY_LIMIT;
        memory_free(column.name);
        return too_many ? fail(CONUS_ERROR_DATA, "Piece: allowed are up to %d arrays", FOREIGN_ARRAY_LIMIT)
                        : CONUS_ERROR_MEMORY;
    }
    vtp->columns[vtp->column_count++] = column;
    return CONUS_OK;
}

static conus_status open_array(struct vtp *vtp, const struct xml_event *event)
{
    const char *format = xml_attribute(event, "format");
    struct vtp_storage storage = {.is_packed = vtp->packed, .swapped = vtp->swapped, .header = vtp->header};
    vtp->use = use_of_array(vtp, event);
    const char *type = xml_attribute(event, "type");
    if (vtp->use >= USES && type && strcmp(type, "String") == 0) { /* texts are no numbers, whatever their name */
        vtp->use = USE_NOTHING;
    }
    if (vtp->use == USE_NOTHING) {
        return CONUS_OK;
    }
    const char *components = xml_attribute(event, "NumberOfComponents");
    conus_status status = CONUS_OK;
    if (vtp->use >= USES) {
        status = add_column(vtp, event);
    } else if (vtp->parts[vtp->use].there) {
        status = fail(CONUS_ERROR_DATA, "line %zu: DataArray: the second of its kind", event->line);
    } else if (vtp->use == USE_POINTS && (!components || strcmp(components, "3") != 0)) {
        status = fail(CONUS_ERROR_DATA, "Points: NumberOfComponents is %.60s, 3 are needed",
                      components ? components : "not given");
    }
    if (status) {
        vtp->use = USE_NOTHING;
        return status;
    }
    storage.max_memory = vtp->max_memory;
    storage.any = vtp->use >= USES;
    storage.is_text = format && strcmp(format, "ascii") == 0;
    bool appended = format && strcmp(format, "appended") == 0;
    storage.is_raw = appended && vtp->appended_raw;
    status = take_type(&storage, type);
    if (!status && !storage.is_text && !appended && (!format || strcmp(format, "binary") != 0)) {
        status = fail(CONUS_ERROR_DATA, "DataArray: format is %.60s, allowed are ascii, binary and appended",
                      format ? format : "not given");
    }
    status = status || !appended ? status : take_appended(&storage, vtp, event);
    struct part *part = open_part(vtp);
    part->there = !status;
    part->storage = storage;
    return status;
}

/* The text of an array that is not appended, which is the parser's, is kept until the piece ends. It ends with the
 * array, or where an element in it begins. */
static conus_status keep_text(struct vtp *vtp, const struct xml_event *event)
{
    struct part *part = open_part(vtp);
    if (part && !part->storage.content.data) {
        part->text.data = (uint8_t *)memory_text(event->text.data, event->text.size);
        part->text.size = event->text.size;
        part->storage.content = (struct text){(const char *)part->text.data, part->text.size};
        if (!part->text.data) {
            return CONUS_ERROR_MEMORY;
        }
    }
    return CONUS_OK;
}

static void forget_parts(struct vtp *vtp)
{
    for (size_t i = 0; i < USES; i++) {
        bytes_finish(&vtp->parts[i].text);
        vtp->parts[i] = (struct part){0};
    }
    for (size_t i = 0; i < vtp->column_count; i++) {
        bytes_finish(&vtp->columns[i].part.text);
        memory_free(vtp->columns[i].name);
    }
    vtp->column_count = 0;
    vtp->use = USE_NOTHING; /* an array that is still open is not read on */
}

/* Memory that was kept is not there for the arrays of the next piece. */
static void spend(struct vtp *vtp, size_t count, size_t size)
{
    uint64_t bytes = (uint64_t)count * size;
    vtp->max_memory -= bytes < vtp->max_memory ? bytes : vtp->max_memory;
}

static conus_status add_points(struct vtp *vtp)
{
    const struct part *part = &vtp->parts[USE_POINTS];
    float *numbers = NULL;
    size_t count = 0;
    conus_status status = part->there ? vtp_floats(&numbers, &count, &part->storage) : CONUS_OK;
    if (!status && (count % 3 || count / 3 != vtp->points)) {
        status = fail(CONUS_ERROR_DATA, "Points: %zu numbers, NumberOfPoints is %llu", count,
                      (unsigned long long)vtp->points);
    }
    for (size_t i = 0; !status && i < count; i += 3) {
        status = foreign_add_vertex(vtp->mesh, &numbers[i]);
    }
    spend(vtp, count, sizeof *numbers);
    memory_free(numbers);
    return status ? fail_in(status, "Points") : CONUS_OK;
}

/* Cells of one kind: corners, and where each cell's end. */
struct cells {
    int64_t *corners, *ends;
    size_t corner_count, count;
};

static conus_status vtp_read_cells(struct cells *out, const struct vtp *vtp, enum use use, uint64_t wanted)
{
    const struct part *corners = &vtp->parts[use];
    const struct part *ends = &vtp->parts[use + 1];
    if (corners->there != ends->there) {
        return fail(CONUS_ERROR_DATA, "both connectivity and offsets are needed");
    }
    conus_status status;
    if (corners->there && ((status = vtp_wholes(&out->corners, &out->corner_count, &corners->storage)) ||
                           (status = vtp_wholes(&out->ends, &out->count, &ends->storage)))) {
        return status;
    }
    return out->count == wanted ? CONUS_OK
                                : fail(CONUS_ERROR_DATA, "%zu offsets, the piece says that there are %llu", out->count,
                                       (unsigned long long)wanted);
}

/* `first` is the number of the piece's first vertex. */
static conus_status add_cells(struct vtp *vtp, size_t first, enum use use, uint64_t wanted)
{
    struct cells cells = {0};
    conus_status status = vtp_read_cells(&cells, vtp, use, wanted);
    size_t at = 0;
    for (size_t i = 0; !status && i < cells.count; i++) {
        if (cells.ends[i] < 0 || (uint64_t)cells.ends[i] < at || (uint64_t)cells.ends[i] > cells.corner_count) {
            status = fail(CONUS_ERROR_DATA, "offset %zu is %lld, they rise to %zu", i, (long long)cells.ends[i],
                          cells.corner_count);
        }
        while (!status && at < (size_t)cells.ends[i]) {
            int64_t index = cells.corners[at++];
            bool fits = index >= 0 && (uint64_t)index < vtp->points;
            status = fits ? foreign_add_corner(vtp->mesh, (int64_t)first + index)
                          : fail(CONUS_ERROR_DATA, "%s %zu: vertex index %lld, the piece has %llu vertices",
                                 foreign_cell_word(vtp->mesh), vtp->mesh->face_count, (long long)index,
                                 (unsigned long long)vtp->points);
        }
        status = status             ? status
                 : use == USE_LINES ? foreign_end_line(vtp->mesh)
                 : use == USE_POLYS ? foreign_end_polygon(vtp->mesh)
                                    : foreign_end_strip(vtp->mesh);
    }
    if (!status && at != cells.corner_count) {
        status = fail(CONUS_ERROR_DATA, "%zu corners, the last offset is %zu", cells.corner_count, at);
    }
    spend(vtp, cells.corner_count, sizeof *vtp->mesh->triangles);
    memory_free(cells.corners);
    memory_free(cells.ends);
    return status ? fail_in(status, use == USE_LINES ? "Lines" : use == USE_POLYS ? "Polys" : "Strips") : CONUS_OK;
}

/* Appends the arrays of the piece to those of the pieces before it, which have `before` points or lines. Of cells it
 * keeps only the arrays of lines. */
static conus_status add_column_values(struct vtp *vtp, const struct column *column, size_t before)
{
    float *numbers = NULL;
    struct foreign_array *array = NULL;
    size_t count = 0;
    uint64_t cells = 0;
    bool too_many = __builtin_add_overflow(vtp->vertices, vtp->lines, &cells) ||
                    __builtin_add_overflow(cells, vtp->polys, &cells) ||
                    __builtin_add_overflow(cells, vtp->strips, &cells);
    uint64_t things = column->per_point ? vtp->points : cells;
    conus_status status =
        foreign_lines_array(&array, vtp->mesh->lines, text_from(column->name), column->per_point, column->components);
    status = status ? status : vtp_floats(&numbers, &count, &column->part.storage);
    if (!status && (too_many || count % column->components || count / column->components != things)) {
        status = fail(CONUS_ERROR_DATA, "%s: %zu numbers, %llu times %llu are needed", column->name, count,
                      (unsigned long long)things, (unsigned long long)column->components);
    }
    if (!status && array->count / array->components != before) {
        status = fail(CONUS_ERROR_DATA, "%s: not in all pieces, or twice", column->name);
    }
    size_t from = column->per_point || status ? 0 : (size_t)vtp->vertices * array->components;
    count = status || column->per_point ? count : (size_t)vtp->lines * array->components;
    status = status ? status : foreign_array_reserve(vtp->mesh->lines, array, count);
    if (!status && count) {
        memcpy(&array->values[array->count], &numbers[from], count * sizeof *numbers);
        array->count += count;
    }
    memory_free(numbers);
    return status;
}

static conus_status end_piece(struct vtp *vtp)
{
    struct foreign_lines *lines = vtp->mesh->lines;
    size_t first = vtp->mesh->vertex_count;
    size_t first_line = lines ? lines->count : 0;
    conus_status status = add_points(vtp);
    status = status || !lines ? status : add_cells(vtp, first, USE_LINES, vtp->lines);
    for (size_t i = 0; !status && i < vtp->column_count; i++) {
        const struct column *column = &vtp->columns[i];
        status = add_column_values(vtp, column, column->per_point ? first : first_line);
    }
    status = status ? status : add_cells(vtp, first, USE_POLYS, vtp->polys);
    status = status ? status : add_cells(vtp, first, USE_STRIPS, vtp->strips);
    forget_parts(vtp);
    return status;
}

/* The field array SPACE: letters as numbers. */
static conus_status take_space(struct vtp *vtp)
{
    static const char word[] = "SPACE=";
    struct part *part = &vtp->parts[USE_SPACE];
    char text[32];
    int64_t *letters = NULL;
    size_t count = 0;
    memcpy(text, word, sizeof word);
    conus_status status = part->there ? vtp_wholes(&letters, &count, &part->storage) : CONUS_OK;
    size_t size = sizeof word - 1;
    for (size_t i = 0; i < count && letters[i] > 0 && letters[i] < 128 && size < sizeof text; i++) {
        text[size++] = (char)letters[i];
    }
    if (count) {
        vtp->mesh->space = foreign_space_in((struct text){text, size});
    }
    memory_free(letters);
    bytes_finish(&part->text);
    *part = (struct part){0};
    vtp->use = USE_NOTHING;
    return status ? fail_in(status, "SPACE") : CONUS_OK;
}

static const struct {
    const char *name;
    enum use place;
} places[] = {{"Points", USE_POINTS},     {"Lines", USE_LINES},     {"Polys", USE_POLYS},
              {"Strips", USE_STRIPS},     {"FieldData", USE_SPACE}, {"PointData", USE_POINT_DATA},
              {"CellData", USE_CELL_DATA}};

static enum use vtp_place_of(const char *name)
{
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        if (strcmp(name, places[i].name) == 0) {
            return places[i].place;
        }
    }
    return USE_NOTHING;
}

static conus_status vtp_on_start(void *user, const struct xml_event *event)
{
    struct vtp *vtp = user;
    enum use place = vtp_place_of(event->name);
    if (!vtp->has_root) {
        return take_root(vtp, event);
    }
    vtp->place = place < USE_NOTHING ? place : vtp->place;
    if (strcmp(event->name, "Piece") == 0) {
        const struct {
            const char *name;
            uint64_t *count;
        } counts[] = {{"NumberOfPoints", &vtp->points},
                      {"NumberOfVerts", &vtp->vertices},
                      {"NumberOfLines", &vtp->lines},
                      {"NumberOfPolys", &vtp->polys},
                      {"NumberOfStrips", &vtp->strips}};
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
            const char *value = xml_attribute(event, counts[i].name);
            *counts[i].count = 0;
            if (value && !text_to_uint(text_from(value), UINT64_MAX, counts[i].count)) {
                return fail(CONUS_ERROR_DATA, "Piece: %s is \"%.60s\", a whole number is needed", counts[i].name,
                            value);
            }
        }
        return CONUS_OK;
    }
    bool array = strcmp(event->name, "DataArray") == 0 || strcmp(event->name, "Array") == 0;
    return array ? open_array(vtp, event) : keep_text(vtp, event);
}

static conus_status vtp_on_end(void *user, const struct xml_event *event)
{
    struct vtp *vtp = user;
    if (strcmp(event->name, "DataArray") == 0 || strcmp(event->name, "Array") == 0) {
        conus_status status = keep_text(vtp, event);
        vtp->use = USE_NOTHING;
        return status;
    }
    enum use place = vtp_place_of(event->name);
    vtp->place = place < USE_NOTHING ? USE_NOTHING : vtp->place;
    return place == USE_SPACE ? take_space(vtp) : strcmp(event->name, "Piece") == 0 ? end_piece(vtp) : CONUS_OK;
}

/* How the appended data are stored stands in their tag, which is behind the arrays. */
static bool is_raw(struct text document)
{
    const char *tag = text_find(document, appended_tag);
    struct text rest = {tag, tag ? (size_t)(document.data + document.size - tag) : 0};
    return text_mentions(rest, "\"raw\"") || text_mentions(rest, "'raw'");
}

conus_status vtp_parse(struct foreign_mesh *out, const uint8_t *data, size_t size, uint64_t limit)
{
    struct vtp vtp = {.mesh = out, .max_memory = limit, .place = USE_NOTHING, .use = USE_NOTHING};
    struct buffer document = {0};
    static const char known[] = "VTKFile/PolyData/Piece/PointData/CellData/FieldData/Points/Verts/Lines/Strips/Polys/"
                                "DataArray/Array/InformationKey/AppendedData";
    const struct xml_handler handler = {
        .start = vtp_on_start, .end = vtp_on_end, .user = &vtp, .known = known, .strange = &out->notes};
    conus_status status = split_appended(&document, &vtp, text_from_bytes(data, size));
    struct text text = {document.data, document.size};
    vtp.appended_raw = !status && vtp.appended.data && is_raw(text);
    status = status ? status : xml_parse(&handler, text);
    forget_parts(&vtp);
    memory_free(vtp.columns);
    buffer_finish(&document);
    return status;
}
