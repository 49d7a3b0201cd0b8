/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses VTK's XML format: polygons, then strips, of each piece; on request lines, and numbers of points and
 * cells. */
#include "loaders/surfaces/foreign/foreign.h"

#include "base/byte_order.h"
#include "base/formats/encoding.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/surfaces/foreign/parts.h"

#include <libdeflate.h>
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
    bool any;            /* NaN and infinity are numbers, too, where they are text. */
    struct text content; /* The numbers; appended ones with whatever follows. */
};

enum { INFLATE_RATIO = 1032 }; /* the most that deflate makes of a byte */

/* Bytes out of a file that may hold them in base64. */
struct stored {
    struct text rest;
    bool is_raw;
    uint8_t group[3]; /* decoded and not taken */
    size_t waiting;   /* bytes of it */
};

/* The next four digits; padding ends a part, behind which another one begins. False where there are none. */
static bool decode_group(struct stored *stored)
{
    uint32_t bits = 0;
    size_t digits = 0;
    size_t padding = 0;
    while (digits < 4 && stored->rest.size) {
        char c = *stored->rest.data;
        stored->rest = (struct text){stored->rest.data + 1, stored->rest.size - 1};
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
    stored->waiting = digits == 4 ? 3 - padding : 0;
    for (size_t i = 0; i < stored->waiting; i++) { /* the last of them first, to be taken from the end */
        stored->group[stored->waiting - 1 - i] = (uint8_t)(bits >> (16 - 8 * i));
    }
    return digits == 4;
}

static bool take_bytes(uint8_t *out, struct stored *stored, size_t size)
{
    if (stored->is_raw) {
        if (size > stored->rest.size) {
            return false;
        }
        memcpy(out, stored->rest.data, size);
        stored->rest = (struct text){stored->rest.data + size, stored->rest.size - size};
        return true;
    }
    for (size_t i = 0; i < size; i++) {
        if (!stored->waiting && !decode_group(stored)) {
            return false;
        }
        out[i] = stored->group[--stored->waiting];
    }
    return true;
}

/* Bytes that the source holds at most. */
static size_t bytes_left(const struct stored *stored)
{
    return stored->is_raw ? stored->rest.size : stored->rest.size / 4 * 3 + 3;
}

static bool take_header(uint64_t *out, struct stored *stored, const struct vtp_storage *storage)
{
    uint8_t bytes[8];
    if (!take_bytes(bytes, stored, storage->header)) {
        return false;
    }
    *out = storage->header == 4 ? order_u32(bytes, storage->swapped) : order_u64(bytes, storage->swapped);
    return true;
}

static void fail_cut_off(struct job *job)
{
    job_bad(job, "DataArray: its data are cut off, or no base64");
}

/* The size, then the bytes. */
static struct bytes read_plain(struct job *job, struct stored *stored, const struct vtp_storage *storage)
{
    uint64_t size;
    if (!take_header(&size, stored, storage) || size > bytes_left(stored)) {
        fail_cut_off(job);
        return (struct bytes){0};
    }
    struct bytes bytes = {.size = (size_t)size};
    bytes.data = job_array(job, &bytes.size, 1);
    if (bytes.data && !take_bytes(bytes.data, stored, bytes.size)) {
        fail_cut_off(job);
    }
    return bytes;
}

/* All blocks have `size` bytes, unpacked, but the last one if `last` is not 0. */
struct blocks {
    uint64_t size, last;
    uint64_t *packed; /* [count] their sizes, packed */
    size_t count;
};

static void read_block_sizes(struct job *job, struct blocks *out, struct stored *stored,
                             const struct vtp_storage *storage)
{
    uint64_t count = 0;
    bool there = take_header(&count, stored, storage);
    if (there && !count) {
        return;
    }
    if (!there || !take_header(&out->size, stored, storage) || !take_header(&out->last, stored, storage) ||
        count > bytes_left(stored) / storage->header) {
        fail_cut_off(job);
        return;
    }
    if (out->last > out->size) {
        job_bad(job, "DataArray: a last block of %llu bytes, the others have %llu", (unsigned long long)out->last,
                (unsigned long long)out->size);
    }
    out->count = (size_t)count;
    out->packed = job_array(job, &out->count, sizeof *out->packed);
    for (size_t i = 0; i < out->count; i++) {
        if (!take_header(&out->packed[i], stored, storage)) {
            fail_cut_off(job);
            return;
        }
    }
}

static uint64_t size_of_block(const struct blocks *blocks, uint64_t i)
{
    return i + 1 == blocks->count && blocks->last ? blocks->last : blocks->size;
}

/* The unpacked size of all blocks; refused where the packed bytes are too few for it, and above `limit`. */
static size_t find_size(struct job *job, const struct blocks *blocks, const struct stored *stored, uint64_t limit)
{
    uint64_t all = 0;
    uint64_t packed = 0;
    for (uint64_t i = 0; i < blocks->count; i++) {
        uint64_t size = size_of_block(blocks, i);
        if (blocks->packed[i] > bytes_left(stored) || size / INFLATE_RATIO > blocks->packed[i] ||
            __builtin_add_overflow(packed, blocks->packed[i], &packed) || __builtin_add_overflow(all, size, &all)) {
            job_bad(job, "DataArray: block %llu has %llu packed bytes for %llu", (unsigned long long)i,
                    (unsigned long long)blocks->packed[i], (unsigned long long)size);
            return 0;
        }
    }
    if (packed > bytes_left(stored)) {
        fail_cut_off(job);
    } else if (all > limit) {
        job_fail(job, CONUS_ERROR_MEMORY, "DataArray: %llu bytes, allowed are %llu (--max-memory)",
                 (unsigned long long)all, (unsigned long long)limit);
    }
    return (size_t)all;
}

static void unpack_block(struct job *job, uint8_t *out, size_t size, struct stored *stored, size_t packed_size)
{
    struct libdeflate_decompressor *unpacker = job_step(job) ? libdeflate_alloc_decompressor() : NULL;
    uint8_t *packed = job_raw(job, packed_size, 1);
    size_t got = 0;
    size_t used = 0;
    if (!packed || !unpacker) {
        job_fail(job, CONUS_ERROR_MEMORY, "no memory to unpack");
    } else if (!take_bytes(packed, stored, packed_size)) {
        fail_cut_off(job);
    } else if (libdeflate_zlib_decompress_ex(unpacker, packed, packed_size, out, size, &used, &got) || got != size ||
               used != packed_size) {
        job_bad(job, "DataArray: a block is damaged, or does not unpack to %zu bytes", size);
    }
    job_drop(job, packed);
    libdeflate_free_decompressor(unpacker);
}

static struct bytes read_packed(struct job *job, struct stored *stored, const struct vtp_storage *storage,
                                uint64_t limit)
{
    struct blocks blocks = {0};
    read_block_sizes(job, &blocks, stored, storage);
    struct bytes bytes = {.size = job_ok(job) ? find_size(job, &blocks, stored, limit) : 0};
    bytes.data = job_array(job, &bytes.size, 1);
    size_t at = 0;
    for (size_t i = 0; i < blocks.count && job_ok(job); i++) {
        size_t block = (size_t)size_of_block(&blocks, i);
        unpack_block(job, bytes.data + at, block, stored, (size_t)blocks.packed[i]);
        at += block;
    }
    job_drop(job, blocks.packed);
    return bytes;
}

/* Unsigned numbers above 2^63 - 1 become -1. */
static int64_t whole_at(const uint8_t *data, const struct vtp_storage *storage)
{
    bool is_signed = storage->kind == VTP_INTEGER;
    int64_t value = order_whole(data, storage->size, is_signed, storage->swapped);
    return is_signed || value >= 0 ? value : -1;
}

static size_t count_words(struct text text)
{
    struct text word;
    size_t count = 0;
    while (text_word(&text, &word)) {
        count++;
    }
    return count;
}

/* Unpacks the numbers of an array that is no text, whose *count it finds; empty for text. */
static struct bytes read_bytes(struct job *job, size_t *count, const struct vtp_storage *storage, uint64_t limit)
{
    struct stored stored = {.rest = storage->content, .is_raw = storage->is_raw};
    if (storage->is_text) {
        *count = count_words(storage->content);
        return (struct bytes){0};
    }
    struct bytes bytes =
        storage->is_packed ? read_packed(job, &stored, storage, limit) : read_plain(job, &stored, storage);
    if (bytes.size % storage->size) {
        job_bad(job, "DataArray: %zu bytes, each number has %zu", bytes.size, storage->size);
    }
    *count = bytes.size / storage->size;
    return bytes;
}

/* The whole numbers of an array, *count of them, to be dropped; those above 2^63 - 1 become -1. An array of more than
 * `limit` bytes is refused. */
static int64_t *read_wholes(struct job *job, size_t *count, const struct vtp_storage *storage, uint64_t limit)
{
    struct bytes bytes = read_bytes(job, count, storage, limit);
    struct scan scan = scan_of(job, storage->content);
    int64_t *out = job_array(job, count, sizeof *out);
    const size_t mark = job_in(job, "DataArray", JOB_ALONE);
    for (size_t i = 0; i < *count; i++) {
        out[i] = storage->is_text ? scan_whole(&scan, INT64_MIN, "a whole number")
                                  : whole_at(bytes.data + i * storage->size, storage);
    }
    job_out(job, mark);
    job_drop(job, bytes.data);
    return out;
}

static float real_at(const uint8_t *data, const struct vtp_storage *storage)
{
    return storage->kind == VTP_REAL ? (float)order_real(data, storage->size, storage->swapped)
                                     : (float)whole_at(data, storage);
}

/* Numbers of any kind as float, rounded once. */
static float *read_floats(struct job *job, size_t *count, const struct vtp_storage *storage, uint64_t limit)
{
    struct bytes bytes = read_bytes(job, count, storage, limit);
    struct scan scan = scan_of(job, storage->content);
    float *out = job_array(job, count, sizeof *out);
    const size_t mark = job_in(job, "DataArray", JOB_ALONE);
    for (size_t i = 0; i < *count; i++) {
        out[i] = storage->is_text ? (storage->any ? scan_any_float : scan_float)(&scan, "a number")
                                  : real_at(bytes.data + i * storage->size, storage);
    }
    job_out(job, mark);
    job_drop(job, bytes.data);
    return out;
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
    char *text; /* the array's own, while the piece is read */
};

/* Numbers of a piece's points or cells. */
struct column {
    struct part part;
    char *name;
    bool per_point;
    uint64_t components;
};

struct vtp {
    struct job *job;
    struct mesh_sink *sink;
    struct text appended; /* behind its underscore */
    bool appended_raw;
    bool packed, swapped;
    size_t header;
    uint64_t max_memory; /* of an array, unpacked; what was kept is not there for the arrays of the next piece */
    bool has_root;
    enum use place;                                  /* in which element we are: USE_POINTS, USE_POLYS and so on */
    enum use use;                                    /* of the array that is open */
    uint64_t points, vertices, lines, polys, strips; /* that the piece says it has; of cells of single vertices */
    struct part parts[USES];
    LIST(struct column) columns; /* The last is the one that is open. */
};

static const char appended_tag[] = "<AppendedData";

/* Appended data are no XML: the document that is returned ends where they begin. */
static struct text split_appended(struct vtp *vtp, struct text text)
{
    const char *tag = text_find(text, appended_tag);
    if (!tag) {
        return text;
    }
    const char *end = text.data + text.size;
    const char *close = memchr(tag, '>', (size_t)(end - tag));
    const char *mark = close ? memchr(close, '_', (size_t)(end - close)) : NULL;
    if (!mark || text_trim((struct text){close + 1, (size_t)(mark - close) - 1}).size) {
        job_bad(vtp->job, "AppendedData: the file is cut off, or no \"_\" begins the data");
        return (struct text){0};
    }
    /* raw or base64 data end with the closing tags, so that a file that is cut off is known */
    static const char last[] = "/VTKFile>";
    struct text rest = text_trim((struct text){mark + 1, (size_t)(end - mark) - 1});
    const char *slash = text_last(rest, '/');
    if (!slash || !text_mentions(rest, "</AppendedData>") ||
        !text_equal((struct text){slash, (size_t)(rest.data + rest.size - slash)}, last)) {
        job_bad(vtp->job, "AppendedData: the file ends before </VTKFile>");
    }
    /* how they are stored stands in their tag, which is behind the arrays */
    const struct text attributes = {tag, (size_t)(close - tag)};
    vtp->appended_raw = text_mentions(attributes, "\"raw\"") || text_mentions(attributes, "'raw'");
    vtp->appended = (struct text){mark + 1, (size_t)(end - mark) - 1};
    static const char tags[] = "/></VTKFile>";
    const size_t kept = (size_t)(close - text.data);
    char *document = job_raw(vtp->job, kept + sizeof tags, 1);
    if (document) {
        memcpy(document, text.data, kept);
        memcpy(document + kept, tags, sizeof tags);
    }
    return (struct text){document, document ? kept + sizeof tags - 1 : 0};
}

static void take_root(struct vtp *vtp, const struct xml_event *event)
{
    const char *type = xml_attribute(event, "type");
    const char *order = xml_attribute(event, "byte_order");
    const char *header = xml_attribute(event, "header_type");
    const char *packer = xml_attribute(event, "compressor");
    bool little = !order || strcmp(order, "LittleEndian") == 0;
    if (strcmp(event->name, "VTKFile") != 0 || !type || strcmp(type, "PolyData") != 0) {
        job_refuse(vtp->job, "VTKFile: type is %.60s, only PolyData is a surface or lines", type ? type : "not given");
    }
    if (!little && strcmp(order, "BigEndian") != 0) {
        job_bad(vtp->job, "VTKFile: byte_order is %.60s, allowed are LittleEndian and BigEndian", order);
    }
    if (header && strcmp(header, "UInt32") != 0 && strcmp(header, "UInt64") != 0) {
        job_bad(vtp->job, "VTKFile: header_type is %.60s, allowed are UInt32 and UInt64", header);
    }
    if (packer && *packer && strcmp(packer, "vtkZLibDataCompressor") != 0) {
        job_refuse(vtp->job, "VTKFile: compressor is %.60s, only vtkZLibDataCompressor is unpacked", packer);
    }
    vtp->has_root = true;
    vtp->packed = packer && *packer;
    vtp->swapped = little == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    vtp->header = header && strcmp(header, "UInt64") == 0 ? 8 : 4;
}

static void take_type(struct job *job, struct vtp_storage *out, const char *type)
{
    static const struct type {
        const char *name;
        enum vtp_kind kind;
        size_t size;
    } types[] = {{"Int8", VTP_INTEGER, 1},    {"UInt8", VTP_UNSIGNED, 1},  {"Int16", VTP_INTEGER, 2},
                 {"UInt16", VTP_UNSIGNED, 2}, {"Int32", VTP_INTEGER, 4},   {"UInt32", VTP_UNSIGNED, 4},
                 {"Int64", VTP_INTEGER, 8},   {"UInt64", VTP_UNSIGNED, 8}, {"Float32", VTP_REAL, 4},
                 {"Float64", VTP_REAL, 8},    {"String", VTP_INTEGER, 1}};
    const struct type *row = ROW_NAMED(types, text_from(type ? type : ""), true);
    if (!row) {
        job_bad(job, "DataArray: type is %.60s, one like Int32 or Float32 is needed", type ? type : "not given");
        return;
    }
    out->kind = row->kind;
    out->size = row->size;
}

static void take_appended(struct vtp_storage *out, const struct vtp *vtp, const struct xml_event *event)
{
    const char *value = xml_attribute(event, "offset");
    uint64_t offset = 0;
    if (!vtp->appended.data) {
        job_bad(vtp->job, "DataArray: its data are appended, and there is no AppendedData");
    }
    if (!value || !text_to_uint(text_from(value), vtp->appended.size, &offset)) {
        job_bad(vtp->job, "DataArray: offset is %.60s, allowed are 0 to %zu", value ? value : "not given",
                vtp->appended.size);
    }
    if (job_ok(vtp->job)) {
        out->content = (struct text){vtp->appended.data + offset, vtp->appended.size - offset};
    }
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
        return !vtp->sink->takes_lines ? USE_NOTHING : corners ? USE_LINES : offsets ? USE_LINE_OFFSETS : USE_NOTHING;
    case USE_POLYS:
        return corners ? USE_POLYS : offsets ? USE_POLY_OFFSETS : USE_NOTHING;
    case USE_STRIPS:
        return corners ? USE_STRIPS : offsets ? USE_STRIP_OFFSETS : USE_NOTHING;
    case USE_SPACE:
        return space ? USE_SPACE : USE_NOTHING;
    case USE_POINT_DATA:
    case USE_CELL_DATA:
        return vtp->sink->takes_lines && name ? vtp->place : USE_NOTHING;
    default:
        return USE_NOTHING;
    }
}

/* The part of the array that is open; NULL where it is not read. */
static struct part *open_part(struct vtp *vtp)
{
    return vtp->use < USES          ? &vtp->parts[vtp->use]
           : vtp->use < USE_NOTHING ? &vtp->columns.at[vtp->columns.count - 1].part
                                    : NULL;
}

static void add_column(struct vtp *vtp, const struct xml_event *event)
{
    const char *name = xml_attribute(event, "Name");
    const char *components = xml_attribute(event, "NumberOfComponents");
    uint64_t count = 1;
    if (components && !text_to_uint(text_from(components), UINT64_MAX, &count)) {
        job_bad(vtp->job, "%.60s: NumberOfComponents is %.60s, a whole number is needed", name, components);
    } else if (vtp->columns.count > SINK_ARRAY_LIMIT) {
        job_bad(vtp->job, "Piece: allowed are up to %d arrays", SINK_ARRAY_LIMIT);
    }
    *LIST_ADD(vtp->job, &vtp->columns) = (struct column){
        .name = job_copy(vtp->job, text_from(name)), .per_point = vtp->use == USE_POINT_DATA, .components = count};
}

static void open_array(struct vtp *vtp, const struct xml_event *event)
{
    const char *format = xml_attribute(event, "format");
    const char *type = xml_attribute(event, "type");
    const char *components = xml_attribute(event, "NumberOfComponents");
    struct vtp_storage storage = {.is_packed = vtp->packed, .swapped = vtp->swapped, .header = vtp->header};
    vtp->use = use_of_array(vtp, event);
    if (vtp->use >= USES && type && strcmp(type, "String") == 0) { /* texts are no numbers, whatever their name */
        vtp->use = USE_NOTHING;
    }
    if (vtp->use == USE_NOTHING) {
        return;
    }
    if (vtp->use >= USES) {
        add_column(vtp, event);
    } else if (vtp->parts[vtp->use].there) {
        job_bad(vtp->job, "line %zu: DataArray: the second of its kind", event->line);
    } else if (vtp->use == USE_POINTS && (!components || strcmp(components, "3") != 0)) {
        job_bad(vtp->job, "Points: NumberOfComponents is %.60s, 3 are needed", components ? components : "not given");
    }
    storage.any = vtp->use >= USES;
    storage.is_text = format && strcmp(format, "ascii") == 0;
    bool appended = format && strcmp(format, "appended") == 0;
    storage.is_raw = appended && vtp->appended_raw;
    take_type(vtp->job, &storage, type);
    if (!storage.is_text && !appended && (!format || strcmp(format, "binary") != 0)) {
        job_bad(vtp->job, "DataArray: format is %.60s, allowed are ascii, binary and appended",
                format ? format : "not given");
    }
    if (appended) {
        take_appended(&storage, vtp, event);
    }
    if (job_ok(vtp->job)) {
        *open_part(vtp) = (struct part){.there = true, .storage = storage};
    }
}

/* The text of an array that is not appended, which is the parser's, is kept until the piece ends. It ends with the
 * array, or where an element in it begins. */
static void keep_text(struct vtp *vtp, const struct xml_event *event)
{
    struct part *part = open_part(vtp);
    if (part && !part->storage.content.data) {
        part->text = job_copy(vtp->job, event->text);
        part->storage.content = (struct text){part->text, job_ok(vtp->job) ? event->text.size : 0};
    }
}

static void forget_part(struct vtp *vtp, struct part *part)
{
    job_drop(vtp->job, part->text);
    *part = (struct part){0};
}

static void forget_parts(struct vtp *vtp)
{
    for (size_t i = 0; i < USES; i++) {
        forget_part(vtp, &vtp->parts[i]);
    }
    for (size_t i = 0; i < vtp->columns.count; i++) {
        forget_part(vtp, &vtp->columns.at[i].part);
    }
    vtp->columns.count = 0;
    vtp->use = USE_NOTHING; /* an array that is still open is not read on */
}

static void spend(struct vtp *vtp, size_t count, size_t size)
{
    uint64_t bytes = (uint64_t)count * size;
    vtp->max_memory -= bytes < vtp->max_memory ? bytes : vtp->max_memory;
}

static void add_points(struct vtp *vtp)
{
    const struct part *part = &vtp->parts[USE_POINTS];
    const size_t mark = job_in(vtp->job, "Points", JOB_ALONE);
    size_t count = 0;
    float *numbers = part->there ? read_floats(vtp->job, &count, &part->storage, vtp->max_memory) : NULL;
    if (count % 3 || count / 3 != vtp->points) {
        job_bad(vtp->job, "Points: %zu numbers, NumberOfPoints is %llu", count, (unsigned long long)vtp->points);
    }
    sink_expect(vtp->sink, vtp->sink->vertices.count + count / 3);
    for (size_t i = 0; i < count && job_ok(vtp->job); i += 3) {
        sink_vertex(vtp->sink, &numbers[i]);
    }
    spend(vtp, count, sizeof *numbers);
    job_drop(vtp->job, numbers);
    job_out(vtp->job, mark);
}

/* Cells of one kind: corners, and where each cell's end. */
struct cells {
    int64_t *corners, *ends;
    size_t corner_count, count;
};

static struct cells read_cells(struct vtp *vtp, enum use use, uint64_t wanted)
{
    const struct part *corners = &vtp->parts[use];
    const struct part *ends = &vtp->parts[use + 1];
    struct cells out = {0};
    if (corners->there != ends->there) {
        job_bad(vtp->job, "both connectivity and offsets are needed");
    } else if (corners->there) {
        out.corners = read_wholes(vtp->job, &out.corner_count, &corners->storage, vtp->max_memory);
        out.ends = read_wholes(vtp->job, &out.count, &ends->storage, vtp->max_memory);
    }
    if (out.count != wanted) {
        job_bad(vtp->job, "%zu offsets, the piece says that there are %llu", out.count, (unsigned long long)wanted);
    }
    return out;
}

/* `first` is the number of the piece's first vertex. */
static void add_cells(struct vtp *vtp, size_t first, enum use use, uint64_t wanted)
{
    static const struct {
        const char *word;
        enum cell cell;
    } kinds[USES] = {[USE_LINES] = {"Lines", CELL_LINE},
                     [USE_POLYS] = {"Polys", CELL_POLYGON},
                     [USE_STRIPS] = {"Strips", CELL_STRIP}};
    struct job *job = vtp->job;
    const size_t mark = job_in(job, kinds[use].word, JOB_ALONE);
    const struct cells cells = read_cells(vtp, use, wanted);
    size_t at = 0;
    for (size_t i = 0; i < cells.count && job_ok(job); i++) {
        if (cells.ends[i] < 0 || (uint64_t)cells.ends[i] < at || (uint64_t)cells.ends[i] > cells.corner_count) {
            job_bad(job, "offset %zu is %lld, they rise to %zu", i, (long long)cells.ends[i], cells.corner_count);
        }
        while (job_ok(job) && at < (size_t)cells.ends[i]) {
            const int64_t index = cells.corners[at++];
            if (index < 0 || (uint64_t)index >= vtp->points) {
                job_bad(job, "%s %zu: vertex index %lld, the piece has %llu vertices", sink_cell_word(vtp->sink),
                        sink_cell(vtp->sink), (long long)index, (unsigned long long)vtp->points);
            }
            sink_corner(vtp->sink, (int64_t)first + index);
        }
        sink_end(vtp->sink, kinds[use].cell);
    }
    if (at != cells.corner_count) {
        job_bad(job, "%zu corners, the last offset is %zu", cells.corner_count, at);
    }
    spend(vtp, cells.corner_count, sizeof(uint32_t));
    job_drop(job, cells.corners);
    job_drop(job, cells.ends);
    job_out(job, mark);
}

/* Appends the arrays of the piece to those of the pieces before it, which have `before` points or lines. Of cells it
 * keeps only the arrays of lines. */
static void add_column_values(struct vtp *vtp, const struct column *column, size_t before)
{
    struct job *job = vtp->job;
    size_t count = 0;
    uint64_t cells = 0;
    bool too_many = __builtin_add_overflow(vtp->vertices, vtp->lines, &cells) ||
                    __builtin_add_overflow(cells, vtp->polys, &cells) ||
                    __builtin_add_overflow(cells, vtp->strips, &cells);
    uint64_t things = column->per_point ? vtp->points : cells;
    struct sink_array *array = sink_array(vtp->sink, text_from(column->name), column->per_point, column->components);
    if (!array) {
        return;
    }
    float *numbers = read_floats(job, &count, &column->part.storage, vtp->max_memory);
    if (too_many || count % column->components || count / column->components != things) {
        job_bad(job, "%s: %zu numbers, %llu times %llu are needed", column->name, count, (unsigned long long)things,
                (unsigned long long)column->components);
    }
    if (array->count / array->components != before) {
        job_bad(job, "%s: not in all pieces, or twice", column->name);
    }
    if (!job_ok(job)) {
        return;
    }
    const size_t from = column->per_point ? 0 : (size_t)vtp->vertices * array->components;
    count = column->per_point ? count : (size_t)vtp->lines * array->components;
    float *values = sink_array_grow(vtp->sink, array, count);
    if (values && count) {
        memcpy(values, &numbers[from], count * sizeof *numbers);
    }
    job_drop(job, numbers);
}

static void end_piece(struct vtp *vtp)
{
    const size_t first = vtp->sink->vertices.count;
    const size_t first_line = vtp->sink->cells[CELL_LINE];
    add_points(vtp);
    if (vtp->sink->takes_lines) {
        add_cells(vtp, first, USE_LINES, vtp->lines);
    }
    for (size_t i = 0; i < vtp->columns.count && job_ok(vtp->job); i++) {
        const struct column *column = &vtp->columns.at[i];
        add_column_values(vtp, column, column->per_point ? first : first_line);
    }
    add_cells(vtp, first, USE_POLYS, vtp->polys);
    add_cells(vtp, first, USE_STRIPS, vtp->strips);
    forget_parts(vtp);
}

/* The field array SPACE: letters as numbers. */
static void take_space(struct vtp *vtp)
{
    static const char word[] = "SPACE=";
    struct part *part = &vtp->parts[USE_SPACE];
    char text[32];
    size_t count = 0;
    size_t size = sizeof word - 1;
    const size_t mark = job_in(vtp->job, "SPACE", JOB_ALONE);
    memcpy(text, word, sizeof word);
    const int64_t *letters = part->there ? read_wholes(vtp->job, &count, &part->storage, vtp->max_memory) : NULL;
    for (size_t i = 0; i < count && letters[i] > 0 && letters[i] < 128 && size < sizeof text; i++) {
        text[size++] = (char)letters[i];
    }
    if (count) {
        sink_said(vtp->sink, (struct text){text, size});
    }
    forget_part(vtp, part);
    vtp->use = USE_NOTHING;
    job_out(vtp->job, mark);
}

static const struct place {
    const char *name;
    enum use place;
} places[] = {{"Points", USE_POINTS},     {"Lines", USE_LINES},     {"Polys", USE_POLYS},
              {"Strips", USE_STRIPS},     {"FieldData", USE_SPACE}, {"PointData", USE_POINT_DATA},
              {"CellData", USE_CELL_DATA}};

static enum use place_of(const char *name)
{
    const struct place *row = ROW_NAMED(places, text_from(name), true);
    return row ? row->place : USE_NOTHING;
}

static void start_piece(struct vtp *vtp, const struct xml_event *event)
{
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
            job_bad(vtp->job, "Piece: %s is \"%.60s\", a whole number is needed", counts[i].name, value);
        }
    }
}

static bool is_array(const struct xml_event *event)
{
    return strcmp(event->name, "DataArray") == 0 || strcmp(event->name, "Array") == 0;
}

/* The parser stops where the job has failed. */
static conus_status on_start(void *user, const struct xml_event *event)
{
    struct vtp *vtp = user;
    enum use place = place_of(event->name);
    if (!vtp->has_root) {
        take_root(vtp, event);
        return vtp->job->status;
    }
    vtp->place = place < USE_NOTHING ? place : vtp->place;
    if (strcmp(event->name, "Piece") == 0) {
        start_piece(vtp, event);
    } else if (is_array(event)) {
        open_array(vtp, event);
    } else {
        keep_text(vtp, event);
    }
    return vtp->job->status;
}

static conus_status on_end(void *user, const struct xml_event *event)
{
    struct vtp *vtp = user;
    enum use place = place_of(event->name);
    if (is_array(event)) {
        keep_text(vtp, event);
        vtp->use = USE_NOTHING;
        return vtp->job->status;
    }
    vtp->place = place < USE_NOTHING ? USE_NOTHING : vtp->place;
    if (place == USE_SPACE) {
        take_space(vtp);
    } else if (strcmp(event->name, "Piece") == 0) {
        end_piece(vtp);
    }
    return vtp->job->status;
}

void vtp_parse(struct mesh_sink *sink, struct text file)
{
    struct job *job = sink->job;
    struct vtp vtp = {.job = job,
                      .sink = sink,
                      .max_memory = memory_limit(job->max_memory),
                      .place = USE_NOTHING,
                      .use = USE_NOTHING};
    static const char known[] = "VTKFile/PolyData/Piece/PointData/CellData/FieldData/Points/Verts/Lines/Strips/Polys/"
                                "DataArray/Array/InformationKey/AppendedData";
    const struct xml_handler handler = {
        .start = on_start, .end = on_end, .user = &vtp, .known = known, .strange = &job->notes};
    const struct text document = split_appended(&vtp, text_from_bytes((const uint8_t *)file.data, file.size));
    (void)JOB_CALL(job, xml_parse(&handler, document));
}
