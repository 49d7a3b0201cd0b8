/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks NRRD headers. */
#include "loaders/volumes/text/nrrd.h"

#include "loaders/volumes/text/header_text.h"
#include "loaders/volumes/text/nrrd_axes.h"
#include "loaders/volumes/text/nrrd_segments.h"

#include <string.h>

static const struct header_key keys[] = {
    {"dimension", NRRD_DIMENSION},
    {"type", NRRD_TYPE},
    {"sizes", NRRD_SIZES},
    {"space", NRRD_SPACE},
    {"space dimension", NRRD_SPACE_DIMENSION},
    {"space directions", NRRD_DIRECTIONS},
    {"space origin", NRRD_ORIGIN},
    {"space units", NRRD_SPACE_UNITS},
    {"kinds", NRRD_KINDS},
    {"spacings", NRRD_SPACINGS},
    {"endian", NRRD_ENDIAN},
    {"encoding", NRRD_ENCODING},
    {"line skip", NRRD_LINE_SKIP},
    {"lineskip", NRRD_LINE_SKIP},
    {"byte skip", NRRD_BYTE_SKIP},
    {"byteskip", NRRD_BYTE_SKIP},
    {"data file", NRRD_DATA_FILE},
    {"datafile", NRRD_DATA_FILE},
    /* Not used, but each may stand only once, too. The measurement frame turns vectors, not places. */
    {"measurement frame", NRRD_UNUSED},
    {"block size", NRRD_UNUSED + 1},
    {"blocksize", NRRD_UNUSED + 1},
    {"thicknesses", NRRD_UNUSED + 2},
    {"axis mins", NRRD_UNUSED + 3},
    {"axismins", NRRD_UNUSED + 3},
    {"axis maxs", NRRD_UNUSED + 4},
    {"axismaxs", NRRD_UNUSED + 4},
    {"centers", NRRD_UNUSED + 5},
    {"centerings", NRRD_UNUSED + 5},
    {"labels", NRRD_UNUSED + 6},
    {"units", NRRD_UNUSED + 7},
    {"min", NRRD_UNUSED + 8},
    {"max", NRRD_UNUSED + 9},
    {"old min", NRRD_UNUSED + 10},
    {"oldmin", NRRD_UNUSED + 10},
    {"old max", NRRD_UNUSED + 11},
    {"oldmax", NRRD_UNUSED + 11},
    {"content", NRRD_UNUSED + 12},
    {"number", NRRD_UNUSED + 13},
    {"sample units", NRRD_UNUSED + 14},
    {"sampleunits", NRRD_UNUSED + 14},
};

static conus_status read_magic(struct text *rest, size_t *lines)
{
    struct text line = {0};
    conus_status status = CONUS_OK;
    bool known = header_line(rest, &line, lines, &status) && line.size == 8 && line.data[6] == '0' &&
                 line.data[7] >= '1' && line.data[7] <= '5';
    return known ? CONUS_OK
                 : fail(CONUS_ERROR_DATA, "magic: found \"%.*s\", allowed are NRRD0001 to NRRD0005", HEADER_SHOW(line));
}

/* "field: value" or "key:=value". */
static conus_status read_line(struct nrrd_header *header, struct text line)
{
    const char *colon = memchr(line.data, ':', line.size);
    size_t length = colon ? (size_t)(colon - line.data) : 0;
    bool spaced = colon && line.size >= length + 2;
    struct text name = {line.data, length};
    struct text value = spaced ? (struct text){colon + 2, line.size - length - 2} : line;
    if (spaced && colon[1] == '=') {
        return nrrd_segments_read(&header->segments, name, value);
    }
    if (!spaced || colon[1] != ' ') {
        return fail(CONUS_ERROR_DATA, "header: found the line \"%.*s\", allowed are \"field: value\", \"key:=value\"",
                    HEADER_SHOW(line));
    }
    int field = header_find(keys, sizeof keys / sizeof keys[0], name);
    return field < 0
               ? fail(CONUS_ERROR_DATA, "header: found the field \"%.*s\", which NRRD does not have", HEADER_SHOW(name))
               : header_keep(&header->fields[field], text_trim(value), name);
}

/* Up to the empty line, or to the end where the voxels lie in another file. */
static conus_status read_lines(struct nrrd_header *header, struct text *rest)
{
    struct text line;
    size_t lines = 0;
    bool ended = false;
    conus_status status = read_magic(rest, &lines);
    while (!ended && header_line(rest, &line, &lines, &status)) {
        ended = line.size == 0;
        status = ended || line.data[0] == '#' ? CONUS_OK : read_line(header, line);
    }
    if (!status && !ended && !header->fields[NRRD_DATA_FILE].data) {
        return fail(CONUS_ERROR_DATA, "header: found no empty line at its end, and no \"data file\"");
    }
    return status;
}

static conus_status read_type(struct text_volume *out, struct text value)
{
    static const struct {
        const char *name;
        struct text_type type;
    } types[] = {{"signed char", {'i', 1}},
                 {"int8", {'i', 1}},
                 {"int8_t", {'i', 1}},
                 {"uchar", {'u', 1}},
                 {"unsigned char", {'u', 1}},
                 {"uint8", {'u', 1}},
                 {"uint8_t", {'u', 1}},
                 {"short", {'i', 2}},
                 {"short int", {'i', 2}},
                 {"signed short", {'i', 2}},
                 {"signed short int", {'i', 2}},
                 {"int16", {'i', 2}},
                 {"int16_t", {'i', 2}},
                 {"ushort", {'u', 2}},
                 {"unsigned short", {'u', 2}},
                 {"unsigned short int", {'u', 2}},
                 {"uint16", {'u', 2}},
                 {"uint16_t", {'u', 2}},
                 {"int", {'i', 4}},
                 {"signed int", {'i', 4}},
                 {"int32", {'i', 4}},
                 {"int32_t", {'i', 4}},
                 {"uint", {'u', 4}},
                 {"unsigned int", {'u', 4}},
                 {"uint32", {'u', 4}},
                 {"uint32_t", {'u', 4}},
                 {"longlong", {'i', 8}},
                 {"long long", {'i', 8}},
                 {"long long int", {'i', 8}},
                 {"signed long long", {'i', 8}},
                 {"int64", {'i', 8}},
                 {"int64_t", {'i', 8}},
                 {"signed long long int", {'i', 8}},
                 {"ulonglong", {'u', 8}},
                 {"unsigned long long", {'u', 8}},
                 {"uint64", {'u', 8}},
                 {"uint64_t", {'u', 8}},
                 {"unsigned long long int", {'u', 8}},
                 {"float", {'f', 4}},
                 {"double", {'f', 8}}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (text_equal_ignoring_case(value, types[i].name)) {
            out->type = types[i].type;
            return CONUS_OK;
        }
    }
    return fail(CONUS_ERROR_DATA, "type: found \"%.*s\", allowed are int8 to uint64, float and double",
                HEADER_SHOW(value));
}

static conus_status read_encoding(struct text_volume *out, struct text value)
{
    static const struct header_key names[] = {{"raw", TEXT_RAW},      {"gzip", TEXT_GZIP},   {"gz", TEXT_GZIP},
                                              {"text", TEXT_NUMBERS}, {"txt", TEXT_NUMBERS}, {"ascii", TEXT_NUMBERS},
                                              {"hex", TEXT_HEX}};
    int encoding = header_find(names, sizeof names / sizeof names[0], value);
    out->encoding = (enum text_encoding)encoding;
    return encoding < 0 ? fail(CONUS_ERROR_UNSUPPORTED, "encoding: found \"%.*s\", allowed are raw, gzip, text and hex",
                               HEADER_SHOW(value))
                        : CONUS_OK;
}

static conus_status read_endian(struct text_volume *out, struct text value)
{
    bool little = text_equal_ignoring_case(value, "little");
    out->big_endian = text_equal_ignoring_case(value, "big");
    if (little || out->big_endian || (!value.data && (out->type.size == 1 || out->encoding == TEXT_NUMBERS))) {
        return CONUS_OK;
    }
    return value.data ? fail(CONUS_ERROR_DATA, "endian: found \"%.*s\", allowed are little and big", HEADER_SHOW(value))
                      : header_need(value, "endian", "allowed are little and big");
}

static conus_status read_skips(struct text_volume *out, const struct nrrd_header *header)
{
    int64_t lines = 0;
    int64_t bytes = 0;
    struct text line_skip = header->fields[NRRD_LINE_SKIP];
    struct text byte_skip = header->fields[NRRD_BYTE_SKIP];
    conus_status status = line_skip.data ? header_integer(&lines, line_skip, 0, "line skip") : CONUS_OK;
    status = status || !byte_skip.data ? status : header_integer(&bytes, byte_skip, -1, "byte skip");
    if (!status && bytes < 0 && out->encoding != TEXT_RAW) {
        return fail(CONUS_ERROR_DATA, "byte skip: found -1, which only the encoding raw allows");
    }
    out->line_skip = (uint64_t)lines;
    out->at_end = bytes < 0;
    out->byte_skip = bytes < 0 ? 0 : (uint64_t)bytes;
    return status;
}

/* "name", but no list or pattern of files: these are slices. */
static conus_status read_file(struct text_volume *out, struct text value)
{
    struct text rest = value;
    struct text word;
    bool list = text_word(&rest, &word) && text_equal(word, "LIST");
    bool pattern = value.data && memchr(value.data, '%', value.size) && text_trim(rest).size;
    if (list || pattern) {
        return fail(CONUS_ERROR_UNSUPPORTED, "data file: found \"%.*s\", allowed is one file", HEADER_SHOW(value));
    }
    return value.data ? header_file(&out->file, value, "data file") : CONUS_OK;
}

static conus_status interpret(struct text_volume *out, struct nrrd_header *header, struct notes *notes)
{
    static const char type_needed[] = "allowed are int8 to uint64, float and double";
    const struct text *fields = header->fields;
    conus_status status = header_need(fields[NRRD_TYPE], "type", type_needed);
    status = status ? status : read_type(out, fields[NRRD_TYPE]);
    status = status ? status : header_need(fields[NRRD_ENCODING], "encoding", "allowed are raw, gzip, text and hex");
    status = status ? status : read_encoding(out, fields[NRRD_ENCODING]);
    status = status ? status : read_endian(out, fields[NRRD_ENDIAN]);
    status = status ? status : read_skips(out, header);
    status = status ? status : nrrd_axes_read(out, header, notes);
    status = status ? status : read_file(out, fields[NRRD_DATA_FILE]);
    return status ? status : nrrd_segments_take(out, &header->segments);
}

conus_status nrrd_parse(struct text_volume *out, const uint8_t *data, size_t size, struct notes *notes)
{
    struct text rest = {(const char *)data, size < HEADER_TEXT_LIMIT ? size : HEADER_TEXT_LIMIT};
    struct nrrd_header header = {0};
    struct text_volume volume = {.format = "NRRD"};
    conus_status status = read_lines(&header, &rest);
    volume.header_size = status ? 0 : (uint64_t)(rest.data - (const char *)data);
    status = status ? status : interpret(&volume, &header, notes);
    nrrd_segments_finish(&header.segments);
    if (status) {
        text_volume_finish(&volume);
    } else {
        *out = volume;
    }
    return status;
}
