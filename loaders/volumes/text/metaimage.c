/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks MetaImage headers, by a table of their keys. */
#include "base/geometry/math3.h"
#include "loaders/volumes/text/text_volume.h"

#include <stdio.h>
#include <string.h>

enum { AXES = 4 };

/* The values of a header. */
struct metaimage {
    struct text_volume *out;
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

static void read_packed_size(struct job *job, void *header, struct text value)
{
    const struct metaimage *meta = header;
    if (meta->compressed && !meta->binary) {
        job_refuse(job, "CompressedData: found True beside BinaryData = False");
    }
    meta->out->encoding = meta->compressed ? TEXT_ZLIB : meta->binary ? TEXT_RAW : TEXT_NUMBERS;
    if (meta->compressed && value.data) {
        meta->out->packed_size = (uint64_t)header_integer(job, value, 0, "CompressedDataSize");
    }
}

static void check_dimensions(struct job *job, void *header, struct text value)
{
    int64_t axes = ((const struct metaimage *)header)->dimensions;
    (void)value;
    if (axes != 3 && axes != AXES) {
        job_refuse(job, "NDims: found %lld, allowed are 3 and 4", (long long)axes);
    }
}

static void metaimage_check_sizes(struct job *job, void *header, struct text value)
{
    const struct metaimage *meta = header;
    (void)value;
    if (meta->sizes.count != (size_t)meta->dimensions) {
        job_bad(job, "DimSize: found %zu numbers, NDims is %lld", meta->sizes.count, (long long)meta->dimensions);
    }
}

/* ElementSpacing, or ElementSize, whose value this is. */
static void read_spacing(struct job *job, void *header, struct text value)
{
    struct metaimage *meta = header;
    bool spacing = meta->spacing_text.data;
    const char *name = spacing ? "ElementSpacing" : "ElementSize";
    value = spacing ? meta->spacing_text : value;
    header_need(job, value, "ElementSpacing", "the size of a voxel is needed");
    header_numbers(job, meta->spacing, (size_t)meta->dimensions, value, name);
    for (size_t i = 0; i < 3; i++) {
        if (!(meta->spacing[i] > 0) || !isfinite(meta->spacing[i])) {
            job_bad(job, "%s: found %g, allowed are finite numbers above 0", name, meta->spacing[i]);
        }
    }
}

/* A fourth axis must not lead into space, nor space into it. */
static void metaimage_read_matrix(struct job *job, void *header, struct text value)
{
    struct metaimage *meta = header;
    double *matrix = meta->matrix;
    size_t axes = (size_t)meta->dimensions;
    if (!value.data) {
        for (size_t i = 0; i < axes; i++) {
            matrix[i * axes + i] = 1;
        }
        job_warn(job, "TransformMatrix is missing: ITK's default was used, i to the left, j to the back, k up; the "
                      "header may state another");
        return;
    }
    header_numbers(job, matrix, axes * axes, value, "TransformMatrix");
    for (size_t i = 0; axes == AXES && i < 3; i++) {
        if (matrix[i * AXES + 3] != 0 || matrix[3 * AXES + i] != 0) {
            job_refuse(job, "TransformMatrix: found a fourth axis that leads into space");
        }
    }
}

static void read_offset(struct job *job, void *header, struct text value)
{
    struct metaimage *meta = header;
    if (value.data) {
        header_numbers(job, meta->offset, (size_t)meta->dimensions, value, "Offset");
    } else {
        job_warn(job, "Offset is missing: ITK's default was used, the first voxel at the origin; the header may state "
                      "another");
    }
}

static void read_unit(struct job *job, void *header, struct text value)
{
    double *mm = &((struct metaimage *)header)->mm;
    bool unknown = !value.data || text_equal(value, "?") || text_equal(value, "");
    ((struct metaimage *)header)->out->has_unit = !unknown;
    *mm = unknown ? 1 : header_unit(value);
    if (!(*mm > 0)) {
        job_refuse(job, "DistanceUnits: found \"%.*s\", allowed are mm, um, cm and m", HEADER_SHOW(value));
    }
}

static void metaimage_read_file(struct job *job, void *header, struct text value)
{
    if (!text_equal_ignoring_case(value, "LOCAL")) {
        ((struct metaimage *)header)->out->file =
            header_file(job, value, "ElementDataFile", "allowed are LOCAL and one file", false);
    }
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
 * keys of MetaIO that are not here say nothing about voxels. */
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
static const char passed_over[] =
    "Comment/ObjectSubType/TransformType/Name/ID/ParentID/Color/Modality/SequenceID/ElementMin/"
    "ElementMax/ElementNBits/ElementComponent/AcquisitionDate/CompressionLevel/"
    "CompressedElementSize/BinaryDataByteOrderMSB/FileFormatVersion";

/* ITK's code of an axis says from where it comes, others write where it leads: only what fits neither is strange. */
static void check_orientation(struct job *job, const struct metaimage *meta)
{
    static const char ends[2][4] = {"LPI", "RAS"};
    struct text value = meta->orientation;
    bool from = value.size == 3;
    bool to = from;
    for (size_t i = 0; i < 3 && (from || to); i++) {
        const double *column = meta->out->world_from_voxel + 4 * i;
        size_t world = 0;
        for (size_t k = 1; k < 3; k++) {
            world = fabs(column[k]) > fabs(column[world]) ? k : world;
        }
        to = to && value.data[i] == ends[column[world] > 0][world];
        from = from && value.data[i] == ends[column[world] <= 0][world];
    }
    if (value.data && !from && !to && !text_equal(value, "???")) {
        job_warn(job, "AnatomicalOrientation says %.*s, which TransformMatrix contradicts; the matrix was used",
                 HEADER_SHOW(value));
    }
}

/* LPS = Offset + directions * spacing * voxel. */
static void metaimage_place(const struct metaimage *meta)
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
}

/* The line of ElementDataFile ends the header. */
static void metaimage_read_lines(struct reader *r, struct header_values *values)
{
    struct text line;
    size_t lines = 0;
    const char *strange = "";
    while (!header_has(values, &table, "ElementDataFile") && header_line(r, &line, &lines)) {
        if (!text_trim(line).size) {
            continue;
        }
        const char *equals = memchr(line.data, '=', line.size);
        size_t length = equals ? (size_t)(equals - line.data) : 0;
        struct text name = text_trim((struct text){line.data, length});
        if (!name.size) {
            job_bad(r->job, "header: found the line \"%.*s\", allowed is \"key = value\"", HEADER_SHOW(line));
            return;
        }
        struct text value = text_trim((struct text){equals + 1, line.size - length - 1});
        if (!header_keep(r->job, values, &table, name, value) && !text_is_one_of(name, passed_over, true)) {
            strange = strange[0] ? job_format(r->job, "%s, %.*s", strange, HEADER_SHOW(name))
                                 : job_format(r->job, "%.*s", HEADER_SHOW(name));
        }
    }
    if (!header_has(values, &table, "ElementDataFile")) {
        header_need(r->job, (struct text){0}, "ElementDataFile", "it ends the header");
    }
    if (strange[0]) {
        job_note(r->job, "keys that are not known were passed over: %s", strange);
    }
}

static void check_metaimage(struct job *job, const struct metaimage *meta)
{
    bool scaled = meta->slope != 1;
    if (meta->binary && meta->big_endian < 0 && (meta->type & 0xff) > 1) {
        job_bad(job, "BinaryDataByteOrderMSB: missing, allowed are True and False");
    }
    if (meta->header_size && meta->out->encoding != TEXT_RAW) {
        job_refuse(job, "HeaderSize: found %lld, which only plain binary voxels allow", (long long)meta->header_size);
    }
    if (meta->header_size > 0 && !meta->out->file) {
        job_refuse(job, "HeaderSize: found %lld beside LOCAL voxels, allowed is 0", (long long)meta->header_size);
    }
    if (scaled || meta->intercept != 0) {
        job_refuse(job, "ElementToIntensityFunction%s: found %g, allowed is %d: ITK applies no scale",
                   scaled ? "Slope" : "Offset", scaled ? meta->slope : meta->intercept, scaled);
    }
    if (meta->channels > 1 && meta->dimensions == AXES) {
        job_refuse(job, "ElementNumberOfChannels: found %lld beside NDims = 4, allowed is 1",
                   (long long)meta->channels);
    }
}

void metaimage_parse(struct job *job, struct text_volume *out, struct reader r)
{
    struct header_values values = {0};
    struct metaimage meta = {.out = out, .binary = true, .big_endian = -1, .channels = 1, .slope = 1};
    *out = (struct text_volume){.format = "MetaImage"};
    metaimage_read_lines(&r, &values);
    header_take(job, &meta, &table, &values);
    check_metaimage(job, &meta);
    if (!job_ok(job)) {
        return;
    }
    out->header_size = reader_at(&r);
    out->type = (struct text_type){(char)(meta.type >> 8), (size_t)meta.type & 0xff};
    out->big_endian = meta.big_endian > 0;
    out->at_end = meta.header_size < 0;
    out->byte_skip = out->at_end ? 0 : (uint64_t)meta.header_size;
    memcpy(out->dim, meta.sizes.values, sizeof out->dim);
    out->count = meta.dimensions == AXES ? meta.sizes.values[3] : meta.channels;
    out->interleaved = meta.channels > 1;
    metaimage_place(&meta);
    check_orientation(job, &meta);
}
