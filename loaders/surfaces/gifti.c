/* SPDX-License-Identifier: BSD-3-Clause */
/* The elements of a GIFTI document. */
#include "loaders/surfaces/gifti.h"

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/base64.h"
#include "base/formats/gzip.h"
#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/path.h"
#include "base/text.h"
#include "loaders/labels/label_cells.h"

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

static conus_status decode_ascii(double *values, const struct gifti_storage *storage, struct text text)
{
    struct text word;
    size_t n = 0;
    for (; text_word(&text, &word); n++) {
        double value;
        if (n < storage->count && (!text_to_double(word, &value) || !fits_type(value, storage->type))) {
            return fail(CONUS_ERROR_DATA, "Data: number %zu is \"%.*s\", one of the array's DataType is needed", n,
                        TEXT_SHOW(word, SHOWN));
        }
        if (n < storage->count) {
            values[gifti_place_of(n, storage)] = value;
        }
    }
    return n == storage->count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "Data: %zu numbers, the Dim attributes ask for %zu", n, storage->count);
}

/* RFC 4648 with white space anywhere, and with its padding. */
static conus_status decode_base64(struct bytes *out, struct text text)
{
    struct bytes bytes = {memory_raw(text.size / 4 + 1, 3), 0};
    uint32_t group = 0;
    size_t digits = 0;
    size_t padding = 0;
    if (!bytes.data) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < text.size; i++) {
        int value = base64_value(text.data[i]);
        if (text.data[i] == ' ' || (text.data[i] >= '\t' && text.data[i] <= '\r')) {
            continue;
        }
        bool pad = text.data[i] == '=' && digits % 4 >= 2;
        if (pad ? padding == 2 : value < 0 || padding) {
            bytes_finish(&bytes);
            return fail(CONUS_ERROR_DATA, "Data: byte 0x%02x at %zu, which base64 does not allow there",
                        (unsigned)(unsigned char)text.data[i], i);
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
        bytes_finish(&bytes);
        return fail(CONUS_ERROR_DATA, "Data: %zu base64 digits, a multiple of 4 is needed", digits);
    }
    *out = bytes;
    return CONUS_OK;
}

/* `packed` as `size` bytes. */
static conus_status unpack_bytes(struct bytes *out, const struct bytes *packed, size_t size)
{
    if (size / INFLATE_RATIO > packed->size) {
        return fail(CONUS_ERROR_DATA, "Data: %zu packed bytes, which cannot be the %zu that the Dim attributes ask for",
                    packed->size, size);
    }
    struct bytes bytes = {memory_raw(size, 1), size};
    if (!bytes.data) {
        return CONUS_ERROR_MEMORY;
    }
    struct libdeflate_decompressor *decompressor = libdeflate_alloc_decompressor();
    if (!decompressor) {
        bytes_finish(&bytes);
        return fail(CONUS_ERROR_MEMORY, "no memory to unpack");
    }
    size_t used = 0;
    size_t got = 0;
    /* gzip is what the encoding's name says, and no known program writes */
    enum libdeflate_result result =
        (gzip_is(packed->data, packed->size) ? libdeflate_gzip_decompress_ex : libdeflate_zlib_decompress_ex)(
            decompressor, packed->data, packed->size, bytes.data, size, &used, &got);
    libdeflate_free_decompressor(decompressor);
    conus_status status = CONUS_OK;
    if (result == LIBDEFLATE_INSUFFICIENT_SPACE || (!result && got != size)) {
        status = fail(CONUS_ERROR_DATA, "Data: unpacks to %s than the %zu bytes that the Dim attributes ask for",
                      result ? "more" : "fewer", size);
    } else if (result || used != packed->size) {
        status =
            fail(CONUS_ERROR_DATA, "Data: %s", result ? "the packed bytes are damaged" : "bytes after the packed ones");
    }
    if (status) {
        bytes_finish(&bytes);
        return status;
    }
    *out = bytes;
    return CONUS_OK;
}

static conus_status read_external_bytes(struct bytes *out, const struct gifti_storage *storage, size_t size)
{
    struct bytes file = {0};
    conus_status status = file_read(&file, storage->path, UINT64_C(1) << 40);
    if (status) {
        return status;
    }
    if (storage->offset > file.size || size > file.size - storage->offset) {
        status = fail(CONUS_ERROR_DATA, "%s: %zu bytes, the array needs %zu from %llu on", storage->path, file.size,
                      size, (unsigned long long)storage->offset);
        bytes_finish(&file);
        return status;
    }
    memmove(file.data, file.data + storage->offset, size);
    *out = (struct bytes){file.data, size};
    return CONUS_OK;
}

static conus_status decode_bytes(struct bytes *out, const struct gifti_storage *storage, struct text text)
{
    struct bytes stored = {0};
    size_t size = storage->count * size_of(storage->type);
    if (storage->encoding == GIFTI_EXTERNAL) {
        return read_external_bytes(out, storage, size);
    }
    conus_status status = decode_base64(&stored, text);
    if (!status && storage->encoding == GIFTI_GZIP_BASE64) {
        status = unpack_bytes(out, &stored, size);
        bytes_finish(&stored);
    } else if (!status && stored.size != size) {
        status = fail(CONUS_ERROR_DATA, "Data: %zu bytes, the Dim attributes ask for %zu", stored.size, size);
        bytes_finish(&stored);
    } else if (!status) {
        *out = stored;
    }
    return status;
}

/* Decodes exactly storage->count numbers into *out, the last index fastest; the caller's to memory_free(). Nothing is
 * allocated for more numbers than `text` can hold. */
static conus_status gifti_data_decode(double **out, const struct gifti_storage *storage, struct text text)
{
    struct bytes bytes = {0};
    bool ascii = storage->encoding == GIFTI_ASCII;
    if (ascii && storage->count > text.size / 2 + 1) { /* a digit and a space each */
        return fail(CONUS_ERROR_DATA, "Data: %zu bytes of text, too few for the %zu numbers of the Dim attributes",
                    text.size, storage->count);
    }
    conus_status status = ascii ? CONUS_OK : decode_bytes(&bytes, storage, text);
    double *values = status ? NULL : memory_raw(storage->count, sizeof *values);
    status = status || values ? status : CONUS_ERROR_MEMORY;
    if (!status && ascii) {
        status = decode_ascii(values, storage, text);
    }
    for (size_t n = 0; !status && !ascii && n < storage->count; n++) {
        values[gifti_place_of(n, storage)] =
            gifti_number_at(bytes.data + n * size_of(storage->type), storage->type, storage->swapped);
    }
    bytes_finish(&bytes);
    if (status) {
        memory_free(values);
        return status;
    }
    *out = values;
    return CONUS_OK;
}

enum { ARRAY_LIMIT = 100000, TRANSFORM_LIMIT = 16 };

struct parsing {
    struct gifti gifti;
    const struct gifti_options *options;
    struct notes *notes;
    bool in_gifti;
    bool counted;                 /* NumberOfDataArrays was given: */
    uint64_t array_count;         /* ... this */
    struct gifti_array *array;    /* the DataArray that is open */
    struct gifti_storage storage; /* of it */
    char *external;               /* storage.path, owned */
    char *md_name;                /* Name of the MD that is open */
    struct label_entry entry;     /* the Label that is open */
};

void gifti_finish(struct gifti *gifti)
{
    for (size_t i = 0; i < gifti->array_count; i++) {
        memory_free(gifti->arrays[i].values);
        memory_free(gifti->arrays[i].name);
        memory_free(gifti->arrays[i].transforms);
    }
    memory_free(gifti->arrays);
    memory_free(gifti->name);
    memory_free(gifti->structure);
    memory_free(gifti->layer);
    memory_free(gifti->geometric_type);
    label_table_finish(&gifti->labels);
    *gifti = (struct gifti){0};
}

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

/* Looks up an attribute that must be there and in the list. */
static conus_status read_word(int *out, const struct xml_event *event, const char *attribute, const struct word *words,
                              const char *allowed)
{
    const char *given = xml_attribute(event, attribute);
    int value = given ? gifti_value_of(words, text_trim(text_from(given))) : -1;
    if (value < 0) {
        return fail(CONUS_ERROR_DATA, "%s: found \"%.60s\", allowed are %s", attribute, given ? given : "", allowed);
    }
    *out = value;
    return CONUS_OK;
}

static conus_status gifti_read_whole(uint64_t *out, const struct xml_event *event, const char *attribute, uint64_t low,
                                     uint64_t high)
{
    const char *given = xml_attribute(event, attribute);
    if (!given || !text_to_uint(text_trim(text_from(given)), high, out) || *out < low) {
        return fail(CONUS_ERROR_DATA, "%s: found \"%.60s\", allowed are whole numbers from %llu to %llu", attribute,
                    given ? given : "", (unsigned long long)low, (unsigned long long)high);
    }
    return CONUS_OK;
}

static conus_status start_gifti(struct parsing *parsing, const struct xml_event *event)
{
    const char *version = xml_attribute(event, "Version");
    if (version && strcmp(version, "1") != 0 && strncmp(version, "1.", 2) != 0) {
        return fail(CONUS_ERROR_UNSUPPORTED, "Version: found \"%.20s\", 1.x is read", version);
    }
    parsing->in_gifti = true;
    parsing->counted = xml_attribute(event, "NumberOfDataArrays") != NULL;
    return parsing->counted ? gifti_read_whole(&parsing->array_count, event, "NumberOfDataArrays", 0, ARRAY_LIMIT)
                            : CONUS_OK;
}

static conus_status end_gifti(struct parsing *parsing, struct text text)
{
    (void)text;
    if (parsing->counted && parsing->array_count != parsing->gifti.array_count) {
        return fail(CONUS_ERROR_DATA, "NumberOfDataArrays: found %llu, but %zu are there",
                    (unsigned long long)parsing->array_count, parsing->gifti.array_count);
    }
    return CONUS_OK;
}

static conus_status read_dims(struct gifti_array *array, const struct xml_event *event, uint64_t max_memory)
{
    uint64_t rank;
    conus_status status = gifti_read_whole(&rank, event, "Dimensionality", 1, GIFTI_RANK_LIMIT);
    array->rank = status ? 0 : (size_t)rank;
    array->count = 1;
    for (size_t d = 0; d < GIFTI_RANK_LIMIT; d++) {
        char name[16];
        uint64_t dim = 1;
        snprintf(name, sizeof name, "Dim%zu", d);
        status = status || d >= array->rank ? status : gifti_read_whole(&dim, event, name, 1, INT64_MAX);
        array->dim[d] = (size_t)dim;
        if (!status && (!memory_multiply(array->count, array->dim[d], &array->count) ||
                        array->count > max_memory / sizeof *array->values)) {
            status = fail(CONUS_ERROR_MEMORY, "%s: found %llu, more numbers than fit in %llu bytes", name,
                          (unsigned long long)dim, (unsigned long long)max_memory);
        }
    }
    return status;
}

/* A plain name: an array can neither leave its folder nor be read from a device. */
static conus_status read_external(struct parsing *parsing, const struct xml_event *event)
{
    const struct gifti_options *options = parsing->options;
    const char *name = xml_attribute(event, "ExternalFileName");
    const char *offset = xml_attribute(event, "ExternalFileOffset");
    if (!options || !options->external || !options->path) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "Encoding: found ExternalFileBinary, arrays in other files are not read unless that is allowed");
    }
    if (!name || !*name || *name == '.' || !path_is_name(name)) {
        return fail(CONUS_ERROR_DATA,
                    "ExternalFileName: found \"%.60s\", allowed is the name of a file beside this one",
                    name ? name : "");
    }
    memory_free(parsing->external);
    parsing->external = file_beside(options->path, name);
    parsing->storage.path = parsing->external;
    return !parsing->external  ? CONUS_ERROR_MEMORY
           : offset && *offset ? gifti_read_whole(&parsing->storage.offset, event, "ExternalFileOffset", 0, INT64_MAX)
                               : CONUS_OK;
}

static conus_status read_storage(struct parsing *parsing, const struct xml_event *event)
{
    struct gifti_array *array = parsing->array;
    const char *intent = xml_attribute(event, "Intent");
    if (!intent || strncmp(intent, "NIFTI_INTENT_", strlen("NIFTI_INTENT_")) != 0) {
        return fail(CONUS_ERROR_DATA, "Intent: found \"%.60s\", allowed are the names of NIfTI intents",
                    intent ? intent : "");
    }
    array->intent = (enum gifti_intent)gifti_value_of(intents, text_from(intent));
    uint64_t max_memory = memory_limit(parsing->options ? parsing->options->max_memory : 0);
    int encoding = 0;
    int type = 0;
    int column_major = false;
    int swapped = false;
    conus_status status;
    if ((status = read_dims(array, event, max_memory)) ||
        (status = read_word(&encoding, event, "Encoding", encodings,
                            "ASCII, Base64Binary, GZipBase64Binary and ExternalFileBinary")) ||
        (status = read_word(&type, event, "DataType", types,
                            "NIFTI_TYPE_ with UINT8, INT32, FLOAT32, INT8, INT16, UINT16, UINT32, INT64, UINT64 and "
                            "FLOAT64")) ||
        (array->rank > 1 && (status = read_word(&column_major, event, "ArrayIndexingOrder", orders,
                                                "RowMajorOrder and ColumnMajorOrder"))) ||
        (encoding != GIFTI_ASCII && size_of(type) > 1 &&
         (status = read_word(&swapped, event, "Endian", endians, "LittleEndian and BigEndian")))) {
        return status;
    }
    parsing->storage = (struct gifti_storage){.encoding = (enum gifti_encoding)encoding,
                                              .type = type,
                                              .swapped = swapped,
                                              .column_major = column_major,
                                              .rank = array->rank,
                                              .count = array->count};
    array->is_single = type == TYPE('f', 4);
    return encoding == GIFTI_EXTERNAL ? read_external(parsing, event) : CONUS_OK;
}

static conus_status start_array(struct parsing *parsing, const struct xml_event *event)
{
    if (parsing->array || !parsing->in_gifti) {
        return fail(CONUS_ERROR_DATA, "DataArray inside another, allowed is one after the other in GIFTI");
    }
    struct gifti *gifti = &parsing->gifti;
    if (gifti->array_count == ARRAY_LIMIT) {
        return fail(CONUS_ERROR_DATA, "more than %d DataArrays", ARRAY_LIMIT);
    }
    struct gifti_array *arrays = memory_resize(gifti->arrays, gifti->array_count + 1, sizeof *arrays);
    if (!arrays) {
        return CONUS_ERROR_MEMORY;
    }
    gifti->arrays = arrays;
    parsing->array = &arrays[gifti->array_count++];
    *parsing->array = (struct gifti_array){0};
    return read_storage(parsing, event);
}

static bool is_outline(const struct parsing *parsing)
{
    return parsing->options && parsing->options->outline;
}

static conus_status end_data(struct parsing *parsing, struct text text)
{
    struct gifti_array *array = parsing->array;
    if (!array || array->values) {
        return fail(CONUS_ERROR_DATA, "Data %s, allowed is one in each DataArray",
                    array ? "twice" : "outside DataArray");
    }
    if (is_outline(parsing)) {
        return CONUS_OK;
    }
    parsing->storage.dim = array->dim;
    return gifti_data_decode(&array->values, &parsing->storage, text);
}

static conus_status end_array(struct parsing *parsing, struct text text)
{
    (void)text;
    if (parsing->array && !parsing->array->values && !is_outline(parsing)) {
        return fail(CONUS_ERROR_DATA, "Data is missing, one is needed in each DataArray");
    }
    parsing->array = NULL;
    return CONUS_OK;
}

static conus_status start_transform(struct gifti_array *array)
{
    if (!array) {
        return fail(CONUS_ERROR_DATA, "CoordinateSystemTransformMatrix outside DataArray");
    }
    if (array->transform_count == TRANSFORM_LIMIT) {
        return fail(CONUS_ERROR_DATA, "more than %d CoordinateSystemTransformMatrix", TRANSFORM_LIMIT);
    }
    struct gifti_transform *transforms =
        memory_resize(array->transforms, array->transform_count + 1, sizeof *transforms);
    if (!transforms) {
        return CONUS_ERROR_MEMORY;
    }
    array->transforms = transforms;
    transforms[array->transform_count] = (struct gifti_transform){0};
    mat4_identity(transforms[array->transform_count++].matrix);
    return CONUS_OK;
}

static void end_space(struct gifti_transform *transform, int *space, struct text text)
{
    const struct text trimmed = text_trim(text);
    int value = trimmed.size ? gifti_value_of(spaces, trimmed) : 0; /* as old programs leave it */
    *space = value < 0 ? 0 : value;
    transform->is_foreign = transform->is_foreign || value < 0;
}

static conus_status end_matrix(double matrix[16], struct text text)
{
    double rows[16];
    struct text word;
    size_t n = 0;
    while (text_word(&text, &word)) {
        if (n == 16 || !text_to_double(word, &rows[n]) || !isfinite(rows[n])) {
            n = 0;
            break;
        }
        n++;
    }
    double columns[16];
    for (size_t i = 0; n == 16 && i < 16; i++) {
        columns[4 * (i % 4) + i / 4] = rows[i];
    }
    if (n != 16 || !mat4_settle_last_row(columns)) {
        return fail(CONUS_ERROR_DATA, "MatrixData: 16 finite numbers by rows are needed, the last row 0 0 0 1");
    }
    memcpy(matrix, columns, sizeof columns);
    return CONUS_OK;
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
static conus_status end_value(struct parsing *parsing, struct text text)
{
    struct gifti *gifti = &parsing->gifti;
    const char *name = parsing->md_name ? parsing->md_name : "";
    if (strcmp(name, "AnatomicalStructurePrimary") == 0 && !gifti->hemisphere) {
        gifti->hemisphere = hemisphere_of(text_trim(text));
    }
    keep_geometry(parsing->array, name, text);
    char **field = strcmp(name, "Name") == 0 ? parsing->array ? &parsing->array->name : &gifti->name
                   : strcmp(name, "AnatomicalStructurePrimary") == 0   ? &gifti->structure
                   : strcmp(name, "AnatomicalStructureSecondary") == 0 ? &gifti->layer
                   : strcmp(name, "GeometricType") == 0                ? &gifti->geometric_type
                                                                       : NULL;
    return field && !*field ? label_set_text(field, text) : CONUS_OK;
}

static conus_status end_name(struct parsing *parsing, struct text text)
{
    text = text_trim(text);
    memory_free(parsing->md_name);
    parsing->md_name = memory_text(text.size ? text.data : "", text.size);
    return parsing->md_name ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status start_label(struct parsing *parsing, const struct xml_event *event)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    label_entry_start(&job, &parsing->entry, event);
    return job_close(&job, NULL, NULL);
}

static conus_status end_label(struct parsing *parsing, struct text text)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    label_entry_end(&job, &parsing->entry, &parsing->gifti.labels, text);
    return job_close(&job, parsing->notes, NULL);
}

static conus_status end_element(struct parsing *parsing, const struct xml_event *event)
{
    static const struct {
        const char *name;
        conus_status (*end)(struct parsing *parsing, struct text text);
    } elements[] = {{"Data", end_data},   {"DataArray", end_array}, {"Name", end_name},
                    {"Value", end_value}, {"Label", end_label},     {"GIFTI", end_gifti}};
    const struct gifti_array *array = parsing->array;
    conus_status status = CONUS_OK;
    if (array && array->transform_count) { /* the CoordinateSystemTransformMatrix that is open, or the last one */
        struct gifti_transform *transform = &array->transforms[array->transform_count - 1];
        if (strcmp(event->name, "DataSpace") == 0) {
            end_space(transform, &transform->data_space, event->text);
        } else if (strcmp(event->name, "TransformedSpace") == 0) {
            end_space(transform, &transform->transformed_space, event->text);
        } else if (strcmp(event->name, "MatrixData") == 0) {
            status = end_matrix(transform->matrix, event->text);
        }
    }
    for (size_t i = 0; !status && i < sizeof elements / sizeof elements[0]; i++) {
        if (strcmp(event->name, elements[i].name) == 0) {
            return elements[i].end(parsing, event->text);
        }
    }
    return status;
}

/* Says where: "line 7, DataArray 1: ...". */
static conus_status fail_at_place(conus_status status, const struct parsing *parsing, const struct xml_event *event)
{
    char where[64];
    if (!status) {
        return CONUS_OK;
    }
    int length = snprintf(where, sizeof where, "line %zu", event->line);
    if (parsing->array) {
        snprintf(where + length, sizeof where - (size_t)length, ", DataArray %zu", parsing->gifti.array_count - 1);
    }
    return status == CONUS_ERROR_MEMORY && !parsing->array ? status : fail_in(status, where);
}

static conus_status gifti_on_start(void *user, const struct xml_event *event)
{
    struct parsing *parsing = user;
    conus_status status = CONUS_OK;
    if (!parsing->in_gifti && strcmp(event->name, "GIFTI") != 0) {
        status = fail(CONUS_ERROR_DATA, "outermost element: found <%.40s>, allowed is <GIFTI>", event->name);
    } else if (strcmp(event->name, "GIFTI") == 0) {
        status = start_gifti(parsing, event);
    } else if (strcmp(event->name, "DataArray") == 0) {
        status = start_array(parsing, event);
    } else if (strcmp(event->name, "Label") == 0) {
        status = start_label(parsing, event);
    } else if (strcmp(event->name, "CoordinateSystemTransformMatrix") == 0) {
        status = start_transform(parsing->array);
    }
    return fail_at_place(status, parsing, event);
}

static conus_status gifti_on_end(void *user, const struct xml_event *event)
{
    return fail_at_place(end_element(user, event), user, event);
}

conus_status gifti_parse(struct gifti *out, const uint8_t *data, size_t size, const struct gifti_options *options,
                         struct notes *notes)
{
    struct parsing parsing = {.options = options, .notes = notes};
    static const char known[] = "GIFTI/MetaData/MD/Name/Value/LabelTable/Label/DataArray/Data/"
                                "CoordinateSystemTransformMatrix/DataSpace/TransformedSpace/MatrixData";
    struct xml_handler handler = {gifti_on_start, gifti_on_end, &parsing, true, notes, known, notes};
    conus_status status = xml_parse(&handler, text_from_bytes(data, size));
    status = status ? status : label_table_sort(&parsing.gifti.labels, notes);
    label_finish(&parsing.entry.label);
    memory_free(parsing.md_name);
    memory_free(parsing.external);
    if (status) {
        gifti_finish(&parsing.gifti);
        return status;
    }
    *out = parsing.gifti;
    return CONUS_OK;
}
