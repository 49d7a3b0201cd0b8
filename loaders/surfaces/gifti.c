/* SPDX-License-Identifier: BSD-3-Clause */
/* The elements of a GIFTI document. */
#include "loaders/surfaces/parts.h"

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/encoding.h"
#include "base/formats/packed.h"
#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/path.h"
#include "base/text.h"
#include "loaders/labels/label_format.h"

#include <libdeflate.h>
#include <stdio.h>
#include <string.h>

enum gifti_encoding { GIFTI_ASCII, GIFTI_BASE64, GIFTI_GZIP_BASE64, GIFTI_EXTERNAL };

/* The type of a number: 'u' unsigned, 'i' signed, 'f' floating point; and its bytes. */
#define TYPE(kind, size) ((kind) << 8 | (size))

/* How an array is stored. */
struct gifti_storage {
    enum gifti_encoding encoding;
    int type;          /* TYPE() */
    bool swapped;      /* Not this machine's byte order.                    */
    bool column_major; /* The first index runs fastest.                     */
    size_t rank;
    const size_t *dim; /* [rank]                                            */
    size_t count;      /* Their product.                                    */
    const char *path;  /* GIFTI_EXTERNAL: the file with the numbers, ...    */
    uint64_t offset;   /* ... and where in it they begin.                   */
};

enum { INFLATE_RATIO = 1032, SHOWN = 20 };

static size_t size_of(int type)
{
    return (size_t)type & 0xff;
}

static double gifti_number_at(const uint8_t *data, int type, bool swapped)
{
    bool is_signed = type >> 8 == 'i';
    if (type >> 8 == 'f') {
        return order_real(data, size_of(type), swapped);
    }
    int64_t whole = order_whole(data, size_of(type), is_signed, swapped);
    return is_signed ? (double)whole : (double)(uint64_t)whole;
}

/* Where the n-th stored number belongs when the last index is to run fastest. */
static size_t gifti_place_of(size_t n, const struct gifti_storage *storage)
{
    if (!storage->column_major) {
        return n;
    }
    size_t place = 0;
    size_t stride = storage->count;
    for (size_t d = 0; d < storage->rank; d++) {
        stride /= storage->dim[d];
        place += n % storage->dim[d] * stride;
        n /= storage->dim[d];
    }
    return place;
}

/* Whether `value` can be one of an integer type; any can be a float. */
static bool fits_type(double value, int type)
{
    bool is_signed = type >> 8 == 'i';
    double end = exp2(8 * (double)size_of(type) - is_signed);
    return type >> 8 == 'f' || (value == floor(value) && value >= (is_signed ? -end : 0) && value < end);
}

static void decode_ascii(struct job *job, double *values, const struct gifti_storage *storage, struct text text)
{
    struct text word;
    size_t n = 0;
    for (; text_word(&text, &word); n++) {
        double value;
        if (n < storage->count && (!text_to_double(word, &value) || !fits_type(value, storage->type))) {
            job_bad(job, "Data: number %zu is \"%.*s\", one of the array's DataType is needed", n,
                    TEXT_SHOW(word, SHOWN));
            return;
        }
        if (n < storage->count) {
            values[gifti_place_of(n, storage)] = value;
        }
    }
    if (n != storage->count) {
        job_bad(job, "Data: %zu numbers, the Dim attributes ask for %zu", n, storage->count);
    }
}

/* RFC 4648 with white space anywhere, and with its padding. */
static struct bytes decode_base64(struct job *job, struct text text)
{
    struct bytes bytes = {job_raw(job, text.size / 4 + 1, 3), 0};
    uint32_t group = 0;
    size_t digits = 0;
    size_t padding = 0;
    for (size_t i = 0; bytes.data && i < text.size; i++) {
        int value = base64_value(text.data[i]);
        if (text.data[i] == ' ' || (text.data[i] >= '\t' && text.data[i] <= '\r')) {
            continue;
        }
        bool pad = text.data[i] == '=' && digits % 4 >= 2;
        if (pad ? padding == 2 : value < 0 || padding) {
            job_bad(job, "Data: byte 0x%02x at %zu, which base64 does not allow there",
                    (unsigned)(unsigned char)text.data[i], i);
            return bytes;
        }
        padding += pad;
        group = group << 6 | (pad ? 0 : (uint32_t)value);
        if (++digits % 4 == 0) {
            for (size_t k = 0; k < 3 - padding; k++) {
                bytes.data[bytes.size++] = (uint8_t)(group >> (16 - 8 * k));
            }
        }
    }
    if (digits % 4) {
        job_bad(job, "Data: %zu base64 digits, a multiple of 4 is needed", digits);
    }
    return bytes;
}

/* `packed` as `size` bytes; NULL after a failure. */
static const uint8_t *unpack_bytes(struct job *job, const struct bytes *packed, size_t size)
{
    if (size / INFLATE_RATIO > packed->size) {
        job_bad(job, "Data: %zu packed bytes, which cannot be the %zu that the Dim attributes ask for", packed->size,
                size);
    }
    uint8_t *data = job_raw(job, size, 1);
    struct libdeflate_decompressor *decompressor = data ? libdeflate_alloc_decompressor() : NULL;
    if (!decompressor) {
        job_fail(job, CONUS_ERROR_MEMORY, "no memory to unpack");
        return NULL;
    }
    size_t used = 0;
    size_t got = 0;
    /* gzip is what the encoding's name says, and no known program writes */
    enum libdeflate_result result =
        (gzip_is(packed->data, packed->size) ? libdeflate_gzip_decompress_ex : libdeflate_zlib_decompress_ex)(
            decompressor, packed->data, packed->size, data, size, &used, &got);
    libdeflate_free_decompressor(decompressor);
    if (result == LIBDEFLATE_INSUFFICIENT_SPACE || (!result && got != size)) {
        job_bad(job, "Data: unpacks to %s than the %zu bytes that the Dim attributes ask for",
                result ? "more" : "fewer", size);
    } else if (result || used != packed->size) {
        job_bad(job, "Data: %s", result ? "the packed bytes are damaged" : "bytes after the packed ones");
    }
    return data;
}

static const uint8_t *read_external_bytes(struct job *job, const struct gifti_storage *storage, size_t size)
{
    struct bytes file = {0};
    (void)JOB_CALL(job, file_read(&file, storage->path, UINT64_C(1) << 40));
    const uint8_t *data = job_adopt(job, file.data);
    if (storage->offset > file.size || size > file.size - storage->offset) {
        job_bad(job, "%s: %zu bytes, the array needs %zu from %llu on", storage->path, file.size, size,
                (unsigned long long)storage->offset);
    }
    return job_ok(job) ? data + storage->offset : NULL;
}

/* The numbers as they are stored, in this many bytes; NULL after a failure. */
static const uint8_t *decode_bytes(struct job *job, const struct gifti_storage *storage, struct text text)
{
    const size_t size = storage->count * size_of(storage->type);
    if (storage->encoding == GIFTI_EXTERNAL) {
        return read_external_bytes(job, storage, size);
    }
    const struct bytes stored = decode_base64(job, text);
    if (storage->encoding == GIFTI_GZIP_BASE64) {
        return unpack_bytes(job, &stored, size);
    }
    if (stored.size != size) {
        job_bad(job, "Data: %zu bytes, the Dim attributes ask for %zu", stored.size, size);
    }
    return stored.data;
}

/* Exactly storage->count numbers, the last index fastest. Nothing is allocated for more numbers than `text` can hold.
 */
static double *gifti_data_decode(struct job *job, const struct gifti_storage *storage, struct text text)
{
    const bool ascii = storage->encoding == GIFTI_ASCII;
    const struct job_mark mark = job_mark(job);
    if (ascii && storage->count > text.size / 2 + 1) { /* a digit and a space each */
        job_bad(job, "Data: %zu bytes of text, too few for the %zu numbers of the Dim attributes", text.size,
                storage->count);
    }
    const uint8_t *bytes = ascii ? NULL : decode_bytes(job, storage, text);
    double *values = job_step(job) ? memory_raw(storage->count, sizeof *values) : NULL; /* outlives the bytes */
    if (job_need(job, values) && ascii) {
        decode_ascii(job, values, storage, text);
    }
    for (size_t n = 0; job_ok(job) && !ascii && n < storage->count; n++) {
        values[gifti_place_of(n, storage)] =
            gifti_number_at(bytes + n * size_of(storage->type), storage->type, storage->swapped);
    }
    job_release(job, mark);
    return job_adopt(job, values);
}

enum { ARRAY_LIMIT = 100000, TRANSFORM_LIMIT = 16 };

struct parsing {
    struct job *job;
    struct gifti *gifti;
    const char *beside; /* the document's path, where arrays may lie in other files; else NULL */
    bool is_outline;
    bool in_gifti;
    bool counted;                 /* NumberOfDataArrays was given: */
    uint64_t array_count;         /* ... this */
    struct gifti_array *array;    /* the DataArray that is open */
    struct gifti_storage storage; /* of it */
    const char *md_name;          /* Name of the MD that is open, or was last */
    struct label_entry entry;     /* the Label that is open */
    char where[64];               /* in the document */
};

/* A word and what it stands for; a list ends with NULL. */
struct word {
    const char *text;
    int value;
};

static const struct word intents[] = {{"NIFTI_INTENT_POINTSET", GIFTI_POINTSET},
                                      {"NIFTI_INTENT_TRIANGLE", GIFTI_TRIANGLE},
                                      {"NIFTI_INTENT_LABEL", GIFTI_LABEL},
                                      {"NIFTI_INTENT_NODE_INDEX", GIFTI_NODE_INDEX},
                                      {NULL, GIFTI_OTHER}};
static const struct word encodings[] = {{"ASCII", GIFTI_ASCII},
                                        {"Base64Binary", GIFTI_BASE64},
                                        {"GZipBase64Binary", GIFTI_GZIP_BASE64},
                                        {"ExternalFileBinary", GIFTI_EXTERNAL},
                                        {"GIFTI_ENCODING_ASCII", GIFTI_ASCII}, /* of old files */
                                        {"GIFTI_ENCODING_B64BIN", GIFTI_BASE64},
                                        {"GIFTI_ENCODING_B64GZ", GIFTI_GZIP_BASE64},
                                        {"GIFTI_ENCODING_EXTBIN", GIFTI_EXTERNAL},
                                        {NULL, -1}};
static const struct word types[] = {{"NIFTI_TYPE_UINT8", TYPE('u', 1)},
                                    {"NIFTI_TYPE_INT32", TYPE('i', 4)},
                                    {"NIFTI_TYPE_FLOAT32", TYPE('f', 4)},
                                    {"NIFTI_TYPE_FLOAT64", TYPE('f', 8)},
                                    {"NIFTI_TYPE_INT8", TYPE('i', 1)},
                                    {"NIFTI_TYPE_INT16", TYPE('i', 2)},
                                    {"NIFTI_TYPE_UINT16", TYPE('u', 2)},
                                    {"NIFTI_TYPE_UINT32", TYPE('u', 4)},
                                    {"NIFTI_TYPE_INT64", TYPE('i', 8)},
                                    {"NIFTI_TYPE_UINT64", TYPE('u', 8)},
                                    {NULL, -1}};
static const struct word orders[] = {{"RowMajorOrder", false}, {"ColumnMajorOrder", true}, {NULL, -1}};
static const struct word endians[] = {{"LittleEndian", !BIG_ENDIAN_IS_SWAPPED},
                                      {"BigEndian", BIG_ENDIAN_IS_SWAPPED},
                                      {"GIFTI_ENDIAN_LITTLE", !BIG_ENDIAN_IS_SWAPPED}, /* of old files */
                                      {"GIFTI_ENDIAN_BIG", BIG_ENDIAN_IS_SWAPPED},
                                      {NULL, -1}};
static const struct word spaces[] = {{"NIFTI_XFORM_UNKNOWN", 0},      {"NIFTI_XFORM_SCANNER_ANAT", 1},
                                     {"NIFTI_XFORM_ALIGNED_ANAT", 2}, {"NIFTI_XFORM_TALAIRACH", 3},
                                     {"NIFTI_XFORM_MNI_152", 4},      {NULL, -1}};

static int gifti_value_of(const struct word *words, struct text text)
{
    while (words->text && !text_equal(text, words->text)) {
        words++;
    }
    return words->value;
}

/* Looks up an attribute that must be there and in the list; 0 after a failure. */
static int read_word(struct job *job, const struct xml_event *event, const char *attribute, const struct word *words,
                     const char *allowed)
{
    const char *given = xml_attribute(event, attribute);
    int value = given ? gifti_value_of(words, text_trim(text_from(given))) : -1;
    if (value < 0) {
        job_bad(job, "%s: found \"%.60s\", allowed are %s", attribute, given ? given : "", allowed);
    }
    return value < 0 ? 0 : value;
}

static void start_gifti(struct parsing *parsing, const struct xml_event *event)
{
    const char *version = xml_attribute(event, "Version");
    if (version && strcmp(version, "1") != 0 && strncmp(version, "1.", 2) != 0) {
        job_refuse(parsing->job, "Version: found \"%.20s\", 1.x is read", version);
    }
    parsing->in_gifti = true;
    parsing->counted = xml_attribute(event, "NumberOfDataArrays") != NULL;
    if (parsing->counted) {
        parsing->array_count = xml_whole(parsing->job, event, "NumberOfDataArrays", 0, ARRAY_LIMIT);
    }
}

static void end_gifti(struct parsing *parsing, struct text text)
{
    (void)text;
    if (parsing->counted && parsing->array_count != parsing->gifti->arrays.count) {
        job_bad(parsing->job, "NumberOfDataArrays: found %llu, but %zu are there",
                (unsigned long long)parsing->array_count, parsing->gifti->arrays.count);
    }
}

static void read_dims(struct job *job, struct gifti_array *array, const struct xml_event *event)
{
    const uint64_t max_memory = memory_limit(job->max_memory);
    array->rank = (size_t)xml_whole(job, event, "Dimensionality", 1, GIFTI_RANK_LIMIT);
    array->count = 1;
    for (size_t d = 0; d < GIFTI_RANK_LIMIT; d++) {
        char name[16];
        snprintf(name, sizeof name, "Dim%zu", d);
        const bool has = d < array->rank && job_ok(job);
        array->dim[d] = has ? (size_t)xml_whole(job, event, name, 1, INT64_MAX) : 1;
        if (!memory_multiply(array->count, array->dim[d], &array->count) ||
            array->count > max_memory / sizeof *array->values) {
            job_fail(job, CONUS_ERROR_MEMORY, "%s: found %zu, more numbers than fit in %llu bytes", name, array->dim[d],
                     (unsigned long long)max_memory);
        }
    }
}

/* A plain name: an array can neither leave its folder nor be read from a device. */
static void read_external(struct parsing *parsing, const struct xml_event *event)
{
    struct job *job = parsing->job;
    const char *name = xml_attribute(event, "ExternalFileName");
    const char *offset = xml_attribute(event, "ExternalFileOffset");
    if (!parsing->beside) {
        job_refuse(job, "Encoding: found ExternalFileBinary, arrays in other files are not read unless that is "
                        "allowed");
    } else if (!name || !*name || *name == '.' || !path_is_name(name)) {
        job_bad(job, "ExternalFileName: found \"%.60s\", allowed is the name of a file beside this one",
                name ? name : "");
    } else {
        parsing->storage.path = job_beside(job, parsing->beside, name);
    }
    if (offset && *offset) {
        parsing->storage.offset = xml_whole(job, event, "ExternalFileOffset", 0, INT64_MAX);
    }
}

static void read_storage(struct parsing *parsing, const struct xml_event *event)
{
    struct job *job = parsing->job;
    struct gifti_array *array = parsing->array;
    const char *intent = xml_attribute(event, "Intent");
    if (!intent || strncmp(intent, "NIFTI_INTENT_", strlen("NIFTI_INTENT_")) != 0) {
        job_bad(job, "Intent: found \"%.60s\", allowed are the names of NIfTI intents", intent ? intent : "");
        return;
    }
    array->intent = (enum gifti_intent)gifti_value_of(intents, text_from(intent));
    read_dims(job, array, event);
    const int encoding =
        read_word(job, event, "Encoding", encodings, "ASCII, Base64Binary, GZipBase64Binary and ExternalFileBinary");
    const int type = read_word(job, event, "DataType", types,
                               "NIFTI_TYPE_ with UINT8, INT32, FLOAT32, INT8, INT16, UINT16, UINT32, INT64, UINT64 and "
                               "FLOAT64");
    parsing->storage = (struct gifti_storage){.encoding = (enum gifti_encoding)encoding,
                                              .type = type,
                                              .rank = array->rank,
                                              .dim = array->dim,
                                              .count = array->count};
    array->is_single = type == TYPE('f', 4);
    if (array->rank > 1) {
        parsing->storage.column_major =
            read_word(job, event, "ArrayIndexingOrder", orders, "RowMajorOrder and ColumnMajorOrder");
    }
    if (encoding != GIFTI_ASCII && size_of(type) > 1) {
        parsing->storage.swapped = read_word(job, event, "Endian", endians, "LittleEndian and BigEndian");
    }
    if (encoding == GIFTI_EXTERNAL) {
        read_external(parsing, event);
    }
}

/* Where the parser is: "line 7, DataArray 1". */
static void set_place(struct parsing *parsing, const struct xml_event *event)
{
    int length = snprintf(parsing->where, sizeof parsing->where, "line %zu", event->line);
    if (parsing->array) {
        snprintf(parsing->where + length, sizeof parsing->where - (size_t)length, ", DataArray %zu",
                 parsing->gifti->arrays.count - 1);
    }
}

static void start_array(struct parsing *parsing, const struct xml_event *event)
{
    struct job *job = parsing->job;
    if (parsing->array || !parsing->in_gifti) {
        job_bad(job, "DataArray inside another, allowed is one after the other in GIFTI");
    } else if (parsing->gifti->arrays.count == ARRAY_LIMIT) {
        job_bad(job, "more than %d DataArrays", ARRAY_LIMIT);
    } else {
        parsing->array = LIST_ADD(job, &parsing->gifti->arrays);
        set_place(parsing, event);
        read_storage(parsing, event);
    }
}

static void end_data(struct parsing *parsing, struct text text)
{
    struct gifti_array *array = parsing->array;
    if (!array || array->values) {
        job_bad(parsing->job, "Data %s, allowed is one in each DataArray", array ? "twice" : "outside DataArray");
    } else if (!parsing->is_outline) {
        array->values = gifti_data_decode(parsing->job, &parsing->storage, text);
    }
}

static void end_array(struct parsing *parsing, struct text text)
{
    (void)text;
    if (parsing->array && !parsing->array->values && !parsing->is_outline) {
        job_bad(parsing->job, "Data is missing, one is needed in each DataArray");
    }
    parsing->array = NULL;
}

static void start_transform(struct parsing *parsing, const struct xml_event *event)
{
    struct gifti_array *array = parsing->array;
    (void)event;
    if (!array) {
        job_bad(parsing->job, "CoordinateSystemTransformMatrix outside DataArray");
    } else if (array->transforms.count == TRANSFORM_LIMIT) {
        job_bad(parsing->job, "more than %d CoordinateSystemTransformMatrix", TRANSFORM_LIMIT);
    } else {
        mat4_identity(LIST_ADD(parsing->job, &array->transforms)->matrix);
    }
}

/* The CoordinateSystemTransformMatrix that is open, or the last one; NULL if there is none. */
static struct gifti_transform *open_transform(const struct parsing *parsing)
{
    const struct gifti_array *array = parsing->array;
    return array && array->transforms.count ? &array->transforms.at[array->transforms.count - 1] : NULL;
}

static int read_space(struct gifti_transform *transform, struct text text)
{
    const struct text trimmed = text_trim(text);
    int value = trimmed.size ? gifti_value_of(spaces, trimmed) : 0; /* as old programs leave it */
    transform->is_foreign = transform->is_foreign || value < 0;
    return value < 0 ? 0 : value;
}

static void end_data_space(struct parsing *parsing, struct text text)
{
    struct gifti_transform *transform = open_transform(parsing);
    if (transform) {
        transform->data_space = read_space(transform, text);
    }
}

static void end_transformed_space(struct parsing *parsing, struct text text)
{
    struct gifti_transform *transform = open_transform(parsing);
    if (transform) {
        transform->transformed_space = read_space(transform, text);
    }
}

static void end_matrix(struct parsing *parsing, struct text text)
{
    struct gifti_transform *transform = open_transform(parsing);
    double columns[16];
    const bool is_matrix = xml_matrix(columns, text) && mat4_settle_last_row(columns);
    if (transform && !is_matrix) {
        job_bad(parsing->job, "MatrixData: 16 finite numbers by rows are needed, the last row 0 0 0 1");
    } else if (transform) {
        memcpy(transform->matrix, columns, sizeof columns);
    }
}

/* Keeps one of FreeSurfer's twelve numbers, "VolGeomX_R". */
static void keep_geometry(struct gifti_array *array, const char *name, struct text text)
{
    bool is_one = array && strncmp(name, "VolGeom", 7) == 0 && strlen(name) == 10 && name[8] == '_';
    static const char columns[] = "XYZC";
    static const char rows[] = "RAS";
    const char *column = is_one ? strchr(columns, name[7]) : NULL;
    const char *row = is_one ? strchr(rows, name[9]) : NULL;
    ptrdiff_t index = column && row ? 3 * (column - columns) + (row - rows) : -1;
    double value;
    if (index >= 0 && text_to_double(text_trim(text), &value) && isfinite(value)) {
        *(index < 9 ? &array->geometry.axes[index] : &array->geometry.centre[index - 9]) = value;
        array->geometry.given |= 1U << index;
    }
}

static char hemisphere_of(struct text structure)
{
    size_t size = structure.size;
    const char *end = structure.data + size;
    return size > 4 && memcmp(end - 4, "Left", 4) == 0              ? 'L'
           : size > 5 && memcmp(end - 5, "Right", 5) == 0           ? 'R'
           : size > 12 && memcmp(end - 12, "LeftAndRight", 12) == 0 ? 'B'
                                                                    : 0;
}

/* The Value of an MD. Only what is used is kept, from the first place that says so. */
static void end_value(struct parsing *parsing, struct text text)
{
    struct gifti *gifti = parsing->gifti;
    const char *name = parsing->md_name;
    if (strcmp(name, "AnatomicalStructurePrimary") == 0 && !gifti->hemisphere) {
        gifti->hemisphere = hemisphere_of(text_trim(text));
    }
    keep_geometry(parsing->array, name, text);
    char **field = strcmp(name, "Name") == 0 ? parsing->array ? &parsing->array->name : &gifti->name
                   : strcmp(name, "AnatomicalStructurePrimary") == 0   ? &gifti->structure
                   : strcmp(name, "AnatomicalStructureSecondary") == 0 ? &gifti->layer
                   : strcmp(name, "GeometricType") == 0                ? &gifti->geometric_type
                                                                       : NULL;
    if (field && !*field) {
        *field = job_name(parsing->job, text);
    }
}

static void end_name(struct parsing *parsing, struct text text)
{
    parsing->md_name = job_copy(parsing->job, text_trim(text));
}

static void start_label(struct parsing *parsing, const struct xml_event *event)
{
    label_entry_start(parsing->job, &parsing->entry, event);
}

static void end_label(struct parsing *parsing, struct text text)
{
    label_entry_end(parsing->job, &parsing->entry, &parsing->gifti->labels, text);
}

static const struct element {
    const char *name;
    void (*start)(struct parsing *parsing, const struct xml_event *event);
    void (*end)(struct parsing *parsing, struct text text);
} elements[] = {
    {"GIFTI", start_gifti, end_gifti},
    {"DataArray", start_array, end_array},
    {"Data", NULL, end_data},
    {"Name", NULL, end_name},
    {"Value", NULL, end_value},
    {"Label", start_label, end_label},
    {"CoordinateSystemTransformMatrix", start_transform, NULL},
    {"DataSpace", NULL, end_data_space},
    {"TransformedSpace", NULL, end_transformed_space},
    {"MatrixData", NULL, end_matrix},
};

static conus_status gifti_on_start(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    struct job *job = parsing->job;
    const struct element *element = ROW_NAMED(elements, text_from(event->name), true);
    const size_t place = job_in(job, parsing->where, JOB_ALONE);
    set_place(parsing, event);
    if (!parsing->in_gifti && strcmp(event->name, "GIFTI") != 0) {
        job_bad(job, "outermost element: found <%.40s>, allowed is <GIFTI>", event->name);
    } else if (element && element->start) {
        element->start(parsing, event);
    }
    job_out(job, place);
    return job->status;
}

static conus_status gifti_on_end(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    const struct element *element = ROW_NAMED(elements, text_from(event->name), true);
    const size_t place = job_in(parsing->job, parsing->where, JOB_ALONE);
    set_place(parsing, event);
    if (element && element->end) {
        element->end(parsing, event->text);
    }
    job_out(parsing->job, place);
    return parsing->job->status;
}

static struct gifti *parse(struct job *job, struct text document, const char *beside, bool is_outline)
{
    static const char known[] = "GIFTI/MetaData/MD/Name/Value/LabelTable/Label/DataArray/Data/"
                                "CoordinateSystemTransformMatrix/DataSpace/TransformedSpace/MatrixData";
    struct gifti *gifti = job_new(job, struct gifti);
    if (!gifti) {
        return NULL;
    }
    labels_own(job, &gifti->labels);
    struct parsing parsing = {.job = job, .gifti = gifti, .beside = beside, .is_outline = is_outline, .md_name = ""};
    const struct xml_handler handler = {gifti_on_start, gifti_on_end, &parsing, true, &job->notes, known, &job->notes};
    (void)JOB_CALL(job, xml_parse(&handler, document));
    labels_sort(job, &gifti->labels);
    return job_ok(job) ? gifti : NULL;
}

struct gifti *gifti_read(struct job *job, struct text document, const char *beside)
{
    return parse(job, document, beside, false);
}

struct gifti *gifti_outline(struct job *job, struct text document)
{
    return parse(job, document, NULL, true);
}
