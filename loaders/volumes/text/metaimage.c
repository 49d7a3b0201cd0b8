/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks MetaImage headers. */
#include "loaders/volumes/text/metaimage.h"

#include "base/geometry/math3.h"
#include "loaders/volumes/text/header_text.h"

#include <stdio.h>
#include <string.h>

enum field {
    OBJECT_TYPE,
    DIMENSIONS,
    BINARY,
    BIG_ENDIAN_DATA,
    COMPRESSED,
    COMPRESSED_SIZE,
    MATRIX,
    OFFSET,
    CENTRE,
    ORIENTATION,
    SPACING,
    SIZE,
    SIZES,
    HEADER_SIZE,
    CHANNELS,
    TYPE,
    DATA_FILE,
    SLOPE,
    INTERCEPT,
    UNITS,
    FIELD_COUNT,
    AXES = 4
};

/* MetaIO has several names for the same; others (Comment, Modality, what a user added) say nothing about voxels. */
static const struct header_key keys[] = {
    {"ObjectType", OBJECT_TYPE},
    {"NDims", DIMENSIONS},
    {"BinaryData", BINARY},
    {"BinaryDataByteOrderMSB", BIG_ENDIAN_DATA},
    {"ElementByteOrderMSB", BIG_ENDIAN_DATA},
    {"CompressedData", COMPRESSED},
    {"CompressedDataSize", COMPRESSED_SIZE},
    {"TransformMatrix", MATRIX},
    {"Rotation", MATRIX},
    {"Orientation", MATRIX},
    {"Offset", OFFSET},
    {"Position", OFFSET},
    {"Origin", OFFSET},
    {"CenterOfRotation", CENTRE},
    {"AnatomicalOrientation", ORIENTATION},
    {"ElementSpacing", SPACING},
    {"ElementSize", SIZE},
    {"DimSize", SIZES},
    {"HeaderSize", HEADER_SIZE},
    {"ElementNumberOfChannels", CHANNELS},
    {"ElementType", TYPE},
    {"ElementDataFile", DATA_FILE},
    {"ElementToIntensityFunctionSlope", SLOPE},
    {"ElementToIntensityFunctionOffset", INTERCEPT},
    {"DistanceUnits", UNITS},
};

struct header {
    struct text fields[FIELD_COUNT];
    size_t axes;
};

static int find_field(struct text name)
{
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (text_equal(name, keys[i].name)) {
            return keys[i].field;
        }
    }
    return -1;
}

/* Splits "key = value". */
static bool split_line(struct text line, struct text *name, struct text *value)
{
    const char *equals = line.size ? memchr(line.data, '=', line.size) : NULL;
    size_t length = equals ? (size_t)(equals - line.data) : 0;
    *name = text_trim((struct text){line.data, length});
    *value = equals ? text_trim((struct text){equals + 1, line.size - length - 1}) : line;
    return equals && name->size;
}

/* The line of ElementDataFile ends the header. */
static conus_status read_lines(struct header *header, struct text *rest)
{
    struct text line;
    struct text name;
    struct text value;
    size_t lines = 0;
    conus_status status = CONUS_OK;
    while (!header->fields[DATA_FILE].data && header_line(rest, &line, &lines, &status)) {
        if (!text_trim(line).size) {
            continue;
        }
        if (!split_line(line, &name, &value)) {
            return fail(CONUS_ERROR_DATA, "header: found the line \"%.*s\", allowed is \"key = value\"",
                        HEADER_SHOW(line));
        }
        int field = find_field(name);
        status = field < 0 ? CONUS_OK : header_keep(&header->fields[field], value, name);
    }
    return status ? status : header_need(header->fields[DATA_FILE], "ElementDataFile", "it ends the header");
}

/* "True", "False", or `missing` where the header has none. */
static conus_status read_truth(bool *out, struct text value, bool missing, const char *name)
{
    static const struct header_key words[] = {{"true", 1}, {"t", 1}, {"1", 1}, {"false", 0}, {"f", 0}, {"0", 0}};
    int truth = value.data ? header_find(words, sizeof words / sizeof words[0], value) : missing;
    *out = truth > 0;
    return truth < 0
               ? fail(CONUS_ERROR_DATA, "%s: found \"%.*s\", allowed are True and False", name, HEADER_SHOW(value))
               : CONUS_OK;
}

static conus_status read_type(struct text_volume *out, struct text value)
{
    static const struct {
        const char *name;
        struct text_type type;
    } types[] = {{"MET_CHAR", {'i', 1}},       {"MET_UCHAR", {'u', 1}}, {"MET_SHORT", {'i', 2}},
                 {"MET_USHORT", {'u', 2}},     {"MET_INT", {'i', 4}},   {"MET_UINT", {'u', 4}},
                 {"MET_LONG", {'i', 4}},       {"MET_ULONG", {'u', 4}}, {"MET_LONG_LONG", {'i', 8}},
                 {"MET_ULONG_LONG", {'u', 8}}, {"MET_FLOAT", {'f', 4}}, {"MET_DOUBLE", {'f', 8}}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (text_equal(value, types[i].name)) {
            out->type = types[i].type;
            return CONUS_OK;
        }
    }
    return value.data ? fail(CONUS_ERROR_UNSUPPORTED,
                             "ElementType: found \"%.*s\", allowed are MET_CHAR to MET_ULONG_LONG, MET_FLOAT and "
                             "MET_DOUBLE",
                             HEADER_SHOW(value))
                      : header_need(value, "ElementType", "MET_UCHAR for example is needed");
}

static conus_status read_encoding(struct text_volume *out, const struct header *header)
{
    bool binary = true;
    bool compressed = false;
    int64_t size = 0;
    const struct text *fields = header->fields;
    struct text packed = fields[COMPRESSED_SIZE];
    conus_status status = read_truth(&binary, fields[BINARY], true, "BinaryData");
    status = status ? status : read_truth(&compressed, fields[COMPRESSED], false, "CompressedData");
    status = status ? status : read_truth(&out->big_endian, fields[BIG_ENDIAN_DATA], false, "BinaryDataByteOrderMSB");
    if (!status && binary && out->type.size > 1) {
        status = header_need(fields[BIG_ENDIAN_DATA], "BinaryDataByteOrderMSB", "allowed are True and False");
    }
    if (!status && compressed && !binary) {
        return fail(CONUS_ERROR_UNSUPPORTED, "CompressedData: found True beside BinaryData = False");
    }
    status = status || !compressed || !packed.data ? status : header_integer(&size, packed, 0, "CompressedDataSize");
    out->encoding = compressed ? TEXT_ZLIB : binary ? TEXT_RAW : TEXT_NUMBERS;
    out->packed_size = (uint64_t)size;
    return status;
}

static conus_status read_header_size(struct text_volume *out, struct text value)
{
    int64_t size = 0;
    conus_status status = value.data ? header_integer(&size, value, -1, "HeaderSize") : CONUS_OK;
    if (!status && size && out->encoding != TEXT_RAW) {
        return fail(CONUS_ERROR_UNSUPPORTED, "HeaderSize: found %lld, which only plain binary voxels allow",
                    (long long)size);
    }
    out->at_end = size < 0;
    out->byte_skip = size < 0 ? 0 : (uint64_t)size;
    return status;
}

static conus_status check_unscaled(const struct header *header)
{
    static const struct {
        int field;
        double value;
        const char *name;
    } fields[] = {{SLOPE, 1, "ElementToIntensityFunctionSlope"}, {INTERCEPT, 0, "ElementToIntensityFunctionOffset"}};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 2; i++) {
        double found = fields[i].value;
        struct text value = header->fields[fields[i].field];
        status = value.data ? header_numbers(&found, 1, value, fields[i].name) : CONUS_OK;
        if (!status && found != fields[i].value) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%s: found %g, allowed is %g: ITK applies no scale", fields[i].name,
                        found, fields[i].value);
        }
    }
    return status;
}

static conus_status read_file(struct text_volume *out, struct text value)
{
    struct text rest = value;
    struct text word;
    bool list = text_word(&rest, &word) && text_equal_ignoring_case(word, "LIST");
    bool pattern = value.size && memchr(value.data, '%', value.size) && text_trim(rest).size;
    if (list || pattern) {
        return fail(CONUS_ERROR_UNSUPPORTED, "ElementDataFile: found \"%.*s\", allowed are LOCAL and one file",
                    HEADER_SHOW(value));
    }
    if (!text_equal_ignoring_case(value, "LOCAL")) {
        return header_file(&out->file, value, "ElementDataFile");
    }
    return out->byte_skip ? fail(CONUS_ERROR_UNSUPPORTED, "HeaderSize: found %llu beside LOCAL voxels, allowed is 0",
                                 (unsigned long long)out->byte_skip)
                          : CONUS_OK;
}

static conus_status read_sizes(struct text_volume *out, struct header *header)
{
    int64_t axes = 0;
    int64_t sizes[AXES] = {0};
    int64_t channels = 1;
    size_t count = 0;
    const struct text *fields = header->fields;
    conus_status status = header_need(fields[DIMENSIONS], "NDims", "allowed are 3 and 4");
    status = status ? status : header_integer(&axes, fields[DIMENSIONS], 1, "NDims");
    if (!status && axes != 3 && axes != AXES) {
        return fail(CONUS_ERROR_UNSUPPORTED, "NDims: found %lld, allowed are 3 and 4", (long long)axes);
    }
    status = status ? status : header_need(fields[SIZES], "DimSize", "a number of each axis is needed");
    status = status ? status : header_integers(sizes, AXES, &count, fields[SIZES], 1, "DimSize");
    if (!status && count != (size_t)axes) {
        return fail(CONUS_ERROR_DATA, "DimSize: found %zu numbers, NDims is %lld", count, (long long)axes);
    }
    struct text values = fields[CHANNELS];
    status = status || !values.data ? status : header_integer(&channels, values, 1, "ElementNumberOfChannels");
    if (!status && channels > 1 && axes == AXES) {
        return fail(CONUS_ERROR_UNSUPPORTED, "ElementNumberOfChannels: found %lld beside NDims = 4, allowed is 1",
                    (long long)channels);
    }
    memcpy(out->dim, sizes, sizeof out->dim);
    out->count = axes == AXES ? sizes[3] : channels;
    out->interleaved = channels > 1;
    header->axes = (size_t)axes;
    return status;
}

static conus_status read_spacing(double out[AXES], const struct header *header)
{
    bool spacing = header->fields[SPACING].data;
    const char *name = spacing ? "ElementSpacing" : "ElementSize";
    struct text value = header->fields[spacing ? SPACING : SIZE];
    conus_status status = header_need(value, "ElementSpacing", "the size of a voxel is needed");
    status = status ? status : header_numbers(out, header->axes, value, name);
    for (size_t i = 0; !status && i < 3; i++) {
        if (!(out[i] > 0) || !isfinite(out[i])) {
            return fail(CONUS_ERROR_DATA, "%s: found %g, allowed are finite numbers above 0", name, out[i]);
        }
    }
    return status;
}

/* The directions of the axes, one after the other. A fourth axis must not lead into space, nor space into it. */
static conus_status read_matrix(double out[AXES * AXES], const struct header *header, struct notes *notes)
{
    size_t axes = header->axes;
    struct text value = header->fields[MATRIX];
    memset(out, 0, AXES * AXES * sizeof *out);
    if (!value.data) {
        for (size_t i = 0; i < axes; i++) {
            out[i * axes + i] = 1;
        }
        return notes_warn(notes, "TransformMatrix is missing: ITK's default was used, i to the left, j to the back, k "
                                 "up");
    }
    conus_status status = header_numbers(out, axes * axes, value, "TransformMatrix");
    for (size_t i = 0; !status && axes == AXES && i < 3; i++) {
        if (out[i * AXES + 3] != 0 || out[3 * AXES + i] != 0) {
            return fail(CONUS_ERROR_UNSUPPORTED, "TransformMatrix: found a fourth axis that leads into space");
        }
    }
    return status;
}

static conus_status read_offset(double out[AXES], const struct header *header, struct notes *notes)
{
    struct text value = header->fields[OFFSET];
    return value.data ? header_numbers(out, header->axes, value, "Offset")
                      : notes_warn(notes, "Offset is missing: ITK's default was used, the first voxel at the origin");
}

static conus_status read_unit(double *mm, struct text value)
{
    bool unknown = !value.data || text_equal(value, "?") || text_equal(value, "");
    *mm = unknown ? 1 : header_unit(value);
    return *mm > 0 ? CONUS_OK
                   : fail(CONUS_ERROR_UNSUPPORTED, "DistanceUnits: found \"%.*s\", allowed are mm, um, cm and m",
                          HEADER_SHOW(value));
}

/* ITK's code of an axis says from where it comes, others write where it leads: only what fits neither is strange. */
static conus_status check_orientation(const struct text_volume *out, struct text value, struct notes *notes)
{
    static const char ends[2][4] = {"LPI", "RAS"};
    bool from = value.size == 3;
    bool to = from;
    for (size_t i = 0; i < 3 && (from || to); i++) {
        const double *column = out->world_from_voxel + 4 * i;
        size_t world = 0;
        for (size_t k = 1; k < 3; k++) {
            world = fabs(column[k]) > fabs(column[world]) ? k : world;
        }
        to = to && value.data[i] == ends[column[world] > 0][world];
        from = from && value.data[i] == ends[column[world] <= 0][world];
    }
    return !value.data || from || to || text_equal(value, "???")
               ? CONUS_OK
               : notes_warn(notes,
                            "AnatomicalOrientation says %.*s, which TransformMatrix contradicts; the matrix was "
                            "used",
                            HEADER_SHOW(value));
}

/* LPS = Offset + directions * spacing * voxel. */
static conus_status place(struct text_volume *out, const struct header *header, struct notes *notes)
{
    double spacing[AXES];
    double matrix[AXES * AXES];
    double offset[AXES] = {0};
    double mm = 1;
    conus_status status = read_spacing(spacing, header);
    status = status ? status : read_matrix(matrix, header, notes);
    status = status ? status : read_offset(offset, header, notes);
    status = status ? status : read_unit(&mm, header->fields[UNITS]);
    if (status) {
        return status;
    }
    mat4_identity(out->world_from_voxel);
    for (size_t i = 0; i < 3; i++) {
        vec3_scale(out->world_from_voxel + 4 * i, matrix + header->axes * i, spacing[i] * mm);
    }
    vec3_scale(out->world_from_voxel + 12, offset, mm);
    header_turn_lps(out->world_from_voxel);
    snprintf(out->transform, sizeof out->transform, "TransformMatrix, LPS");
    return check_orientation(out, header->fields[ORIENTATION], notes);
}

static conus_status interpret(struct text_volume *out, struct header *header, struct notes *notes)
{
    struct text type = header->fields[OBJECT_TYPE];
    if (type.data && !text_equal_ignoring_case(type, "Image")) {
        return fail(CONUS_ERROR_UNSUPPORTED, "ObjectType: found \"%.*s\", allowed is Image", HEADER_SHOW(type));
    }
    conus_status status = read_type(out, header->fields[TYPE]);
    status = status ? status : read_encoding(out, header);
    status = status ? status : read_header_size(out, header->fields[HEADER_SIZE]);
    status = status ? status : check_unscaled(header);
    status = status ? status : read_sizes(out, header);
    status = status ? status : place(out, header, notes);
    return status ? status : read_file(out, header->fields[DATA_FILE]);
}

conus_status metaimage_parse(struct text_volume *out, const uint8_t *data, size_t size, struct notes *notes)
{
    struct text rest = {(const char *)data, size < HEADER_TEXT_LIMIT ? size : HEADER_TEXT_LIMIT};
    struct header header = {0};
    struct text_volume volume = {.format = "MetaImage"};
    conus_status status = read_lines(&header, &rest);
    volume.header_size = status ? 0 : (uint64_t)(rest.data - (const char *)data);
    status = status ? status : interpret(&volume, &header, notes);
    if (status) {
        text_volume_finish(&volume);
    } else {
        *out = volume;
    }
    return status;
}
