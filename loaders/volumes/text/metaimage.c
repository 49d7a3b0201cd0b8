/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks MetaImage headers, by a table of their keys. */
#include "base/geometry/math3.h"
#include "loaders/volumes/text/header_text.h"
#include "loaders/volumes/text/text_volume.h"

#include <stdio.h>
#include <string.h>

enum { AXES = 4 };

/* The values of a header. */
struct metaimage {
    struct text_volume *out;
    struct notes *notes;
    int object_type, type; /* type: kind << 8 | bytes */
    int binary, compressed;
    int big_endian; /* -1 = not said */
    int64_t header_size, dimensions, channels;
    double slope, intercept;
    struct header_list sizes;
    struct text spacing_text, orientation;
    double spacing[AXES];
    double matrix[AXES * AXES]; /* the directions of the axes, one after the other */
    double offset[AXES];
    double mm; /* of a unit */
};

static conus_status read_packed_size(void *header, struct text value)
{
    const struct metaimage *meta = header;
    int64_t size = 0;
    if (meta->compressed && !meta->binary) {
        return fail(CONUS_ERROR_UNSUPPORTED, "CompressedData: found True beside BinaryData = False");
    }
    conus_status status =
        meta->compressed && value.data ? header_integer(&size, value, 0, "CompressedDataSize") : CONUS_OK;
    meta->out->encoding = meta->compressed ? TEXT_ZLIB : meta->binary ? TEXT_RAW : TEXT_NUMBERS;
    meta->out->packed_size = (uint64_t)size;
    return status;
}

static conus_status check_dimensions(void *header, struct text value)
{
    int64_t axes = ((const struct metaimage *)header)->dimensions;
    (void)value;
    return axes == 3 || axes == AXES
               ? CONUS_OK
               : fail(CONUS_ERROR_UNSUPPORTED, "NDims: found %lld, allowed are 3 and 4", (long long)axes);
}

static conus_status metaimage_check_sizes(void *header, struct text value)
{
    const struct metaimage *meta = header;
    (void)value;
    return meta->sizes.count == (size_t)meta->dimensions
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "DimSize: found %zu numbers, NDims is %lld", meta->sizes.count,
                      (long long)meta->dimensions);
}

/* ElementSpacing, or ElementSize, whose value this is. */
static conus_status read_spacing(void *header, struct text value)
{
    struct metaimage *meta = header;
    bool spacing = meta->spacing_text.data;
    const char *name = spacing ? "ElementSpacing" : "ElementSize";
    value = spacing ? meta->spacing_text : value;
    conus_status status = header_need(value, "ElementSpacing", "the size of a voxel is needed");
    status = status ? status : header_numbers(meta->spacing, (size_t)meta->dimensions, value, name);
    for (size_t i = 0; !status && i < 3; i++) {
        if (!(meta->spacing[i] > 0) || !isfinite(meta->spacing[i])) {
            return fail(CONUS_ERROR_DATA, "%s: found %g, allowed are finite numbers above 0", name, meta->spacing[i]);
        }
    }
    return status;
}

/* A fourth axis must not lead into space, nor space into it. */
static conus_status metaimage_read_matrix(void *header, struct text value)
{
    struct metaimage *meta = header;
    double *matrix = meta->matrix;
    size_t axes = (size_t)meta->dimensions;
    if (!value.data) {
        for (size_t i = 0; i < axes; i++) {
            matrix[i * axes + i] = 1;
        }
        return notes_warn(meta->notes, "TransformMatrix is missing: ITK's default was used, i to the left, j to the "
                                       "back, k up");
    }
    conus_status status = header_numbers(matrix, axes * axes, value, "TransformMatrix");
    for (size_t i = 0; !status && axes == AXES && i < 3; i++) {
        if (matrix[i * AXES + 3] != 0 || matrix[3 * AXES + i] != 0) {
            return fail(CONUS_ERROR_UNSUPPORTED, "TransformMatrix: found a fourth axis that leads into space");
        }
    }
    return status;
}

static conus_status read_offset(void *header, struct text value)
{
    struct metaimage *meta = header;
    return value.data ? header_numbers(meta->offset, (size_t)meta->dimensions, value, "Offset")
                      : notes_warn(meta->notes, "Offset is missing: ITK's default was used, the first voxel at the "
                                                "origin");
}

static conus_status read_unit(void *header, struct text value)
{
    double *mm = &((struct metaimage *)header)->mm;
    bool unknown = !value.data || text_equal(value, "?") || text_equal(value, "");
    *mm = unknown ? 1 : header_unit(value);
    return *mm > 0 ? CONUS_OK
                   : fail(CONUS_ERROR_UNSUPPORTED, "DistanceUnits: found \"%.*s\", allowed are mm, um, cm and m",
                          HEADER_SHOW(value));
}

static conus_status metaimage_read_file(void *header, struct text value)
{
    struct text_volume *out = ((struct metaimage *)header)->out;
    return text_equal_ignoring_case(value, "LOCAL")
               ? CONUS_OK
               : header_file(&out->file, value, "ElementDataFile", "allowed are LOCAL and one file", false);
}

#define TYPE(kind, size) ((kind) << 8 | (size))
#define TRUTHS "allowed are True and False"

static const struct header_word object_types[] = {{"Image", 1}, {NULL, 0}};
static const struct header_word truths[] = {{"true/t/1", 1}, {"false/f/0", 0}, {NULL, 0}};
static const struct header_word types[] = {{"MET_CHAR", TYPE('i', 1)},
                                           {"MET_UCHAR", TYPE('u', 1)},
                                           {"MET_SHORT", TYPE('i', 2)},
                                           {"MET_USHORT", TYPE('u', 2)},
                                           {"MET_INT/MET_LONG", TYPE('i', 4)},
                                           {"MET_UINT/MET_ULONG", TYPE('u', 4)},
                                           {"MET_LONG_LONG", TYPE('i', 8)},
                                           {"MET_ULONG_LONG", TYPE('u', 8)},
                                           {"MET_FLOAT", TYPE('f', 4)},
                                           {"MET_DOUBLE", TYPE('f', 8)},
                                           {NULL, 0}};

/* In the order in which they are read: a check may look at what stands above it. MetaIO has several names for the same;
 * keys that are not here (Comment, Modality, what a user added) say nothing about voxels. */
#define AT(member) .place = offsetof(struct metaimage, member)
static const struct header_row rows[] = {
    {"ObjectType", HEADER_WORD, AT(object_type), NULL, object_types, "allowed is Image", CONUS_ERROR_UNSUPPORTED},
    {"ElementType", HEADER_WORD, AT(type), "MET_UCHAR for example is needed", types,
     "allowed are MET_CHAR to MET_ULONG_LONG, MET_FLOAT and MET_DOUBLE", CONUS_ERROR_UNSUPPORTED, .exact = true},
    {"BinaryData", HEADER_WORD, AT(binary), NULL, truths, TRUTHS},
    {"CompressedData", HEADER_WORD, AT(compressed), NULL, truths, TRUTHS},
    {"BinaryDataByteOrderMSB/ElementByteOrderMSB", HEADER_WORD, AT(big_endian), NULL, truths, TRUTHS},
    {"CompressedDataSize", HEADER_UNUSED, .check = read_packed_size},
    {"HeaderSize", HEADER_INTEGER, AT(header_size), .least = -1},
    {"ElementToIntensityFunctionSlope", HEADER_NUMBER, AT(slope)},
    {"ElementToIntensityFunctionOffset", HEADER_NUMBER, AT(intercept)},
    {"NDims", HEADER_INTEGER, AT(dimensions), "allowed are 3 and 4", .least = 1, .check = check_dimensions},
    {"DimSize", HEADER_INTEGERS, AT(sizes), "a number of each axis is needed", .least = 1,
     .check = metaimage_check_sizes},
    {"ElementNumberOfChannels", HEADER_INTEGER, AT(channels), .least = 1},
    {"ElementSpacing", HEADER_TEXT, AT(spacing_text)},
    {"ElementSize", HEADER_UNUSED, .check = read_spacing},
    {"TransformMatrix/Rotation/Orientation", HEADER_UNUSED, .check = metaimage_read_matrix},
    {"Offset/Position/Origin", HEADER_UNUSED, .check = read_offset},
    {"DistanceUnits", HEADER_UNUSED, .check = read_unit},
    {"AnatomicalOrientation", HEADER_TEXT, AT(orientation)},
    {"CenterOfRotation", .kind = HEADER_UNUSED},
    {"ElementDataFile", HEADER_UNUSED, .check = metaimage_read_file},
};
static const struct header_table table = {rows, sizeof rows / sizeof rows[0], .exact = true};

/* ITK's code of an axis says from where it comes, others write where it leads: only what fits neither is strange. */
static conus_status check_orientation(const struct metaimage *meta)
{
    const struct text_volume *out = meta->out;
    struct text value = meta->orientation;
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
               : notes_warn(meta->notes,
                            "AnatomicalOrientation says %.*s, which TransformMatrix contradicts; the matrix was "
                            "used",
                            HEADER_SHOW(value));
}

/* LPS = Offset + directions * spacing * voxel. */
static conus_status metaimage_place(const struct metaimage *meta)
{
    struct text_volume *out = meta->out;
    mat4_identity(out->world_from_voxel);
    for (size_t i = 0; i < 3; i++) {
        vec3_scale(out->world_from_voxel + 4 * i, meta->matrix + (size_t)meta->dimensions * i,
                   meta->spacing[i] * meta->mm);
    }
    vec3_scale(out->world_from_voxel + 12, meta->offset, meta->mm);
    header_turn_lps(out->world_from_voxel);
    snprintf(out->transform, sizeof out->transform, "TransformMatrix, LPS");
    return check_orientation(meta);
}

/* The line of ElementDataFile ends the header. */
static conus_status metaimage_read_lines(struct header_values *values, struct text *rest)
{
    struct text line;
    size_t lines = 0;
    conus_status status = CONUS_OK;
    while (!header_has(values, &table, "ElementDataFile") && header_line(rest, &line, &lines, &status)) {
        if (!text_trim(line).size) {
            continue;
        }
        const char *equals = memchr(line.data, '=', line.size);
        size_t length = equals ? (size_t)(equals - line.data) : 0;
        struct text name = text_trim((struct text){line.data, length});
        if (!name.size) {
            return fail(CONUS_ERROR_DATA, "header: found the line \"%.*s\", allowed is \"key = value\"",
                        HEADER_SHOW(line));
        }
        bool known;
        struct text value = text_trim((struct text){equals + 1, line.size - length - 1});
        status = header_keep(values, &known, &table, name, value);
    }
    return status;
}

/* Checks values against each other. */
static conus_status check_metaimage(const struct metaimage *meta)
{
    if (meta->binary && meta->big_endian < 0 && (meta->type & 0xff) > 1) {
        return fail(CONUS_ERROR_DATA, "BinaryDataByteOrderMSB: missing, allowed are True and False");
    }
    if (meta->header_size && meta->out->encoding != TEXT_RAW) {
        return fail(CONUS_ERROR_UNSUPPORTED, "HeaderSize: found %lld, which only plain binary voxels allow",
                    (long long)meta->header_size);
    }
    if (meta->header_size > 0 && !meta->out->file) {
        return fail(CONUS_ERROR_UNSUPPORTED, "HeaderSize: found %lld beside LOCAL voxels, allowed is 0",
                    (long long)meta->header_size);
    }
    bool scaled = meta->slope != 1;
    if (scaled || meta->intercept != 0) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "ElementToIntensityFunction%s: found %g, allowed is %d: ITK applies no scale",
                    scaled ? "Slope" : "Offset", scaled ? meta->slope : meta->intercept, scaled);
    }
    return meta->channels > 1 && meta->dimensions == AXES
               ? fail(CONUS_ERROR_UNSUPPORTED, "ElementNumberOfChannels: found %lld beside NDims = 4, allowed is 1",
                      (long long)meta->channels)
               : CONUS_OK;
}

conus_status metaimage_parse(struct text_volume *out, const uint8_t *data, size_t size, struct notes *notes)
{
    struct text rest = {(const char *)data, size < HEADER_TEXT_LIMIT ? size : HEADER_TEXT_LIMIT};
    struct header_values values = {0};
    struct text_volume volume = {.format = "MetaImage"};
    struct metaimage meta = {
        .out = &volume, .notes = notes, .binary = true, .big_endian = -1, .channels = 1, .slope = 1};
    conus_status status = metaimage_read_lines(&values, &rest);
    if (!status && !header_has(&values, &table, "ElementDataFile")) {
        status = header_need((struct text){0}, "ElementDataFile", "it ends the header");
    }
    status = status ? status : header_take(&meta, &table, &values);
    status = status ? status : check_metaimage(&meta);
    if (!status) {
        volume.header_size = (uint64_t)(rest.data - (const char *)data);
        volume.type = (struct text_type){(char)(meta.type >> 8), (size_t)meta.type & 0xff};
        volume.big_endian = meta.big_endian > 0;
        volume.at_end = meta.header_size < 0;
        volume.byte_skip = volume.at_end ? 0 : (uint64_t)meta.header_size;
        memcpy(volume.dim, meta.sizes.values, sizeof volume.dim);
        volume.count = meta.dimensions == AXES ? meta.sizes.values[3] : meta.channels;
        volume.interleaved = meta.channels > 1;
        status = metaimage_place(&meta);
    }
    if (status) {
        text_volume_finish(&volume);
    } else {
        *out = volume;
    }
    return status;
}
