/* SPDX-License-Identifier: BSD-3-Clause */
/* The metadata of an array: zarr.json of version 3, .zarray of version 2. */
#include "base/byte_order.h"
#include "base/formats/json_text.h"
#include "base/memory.h"
#include "loaders/zarr/zarr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The text of a value, "" for a value of another kind. */
static const char *text_of(const json_t *value)
{
    const char *text = json_string_value(value);
    return text ? text : "";
}

/* An extension point is a name, or an object of a name and its configuration, NULL where there is none. */
static const char *name_of(const json_t **configuration, const json_t *value)
{
    *configuration = json_object_get(value, "configuration");
    return text_of(json_is_string(value) ? value : json_object_get(value, "name"));
}

static conus_status refuse(const char *key, const char *found, const char *allowed)
{
    return fail(CONUS_ERROR_UNSUPPORTED, "%s: found \"%.*s\", allowed are %s", key, ZARR_NAME, found, allowed);
}

static conus_status read_extents(uint64_t out[ZARR_AXES], const json_t *list, size_t rank, const char *key)
{
    bool good = json_is_array(list) && json_array_size(list) == rank;
    for (size_t i = 0; good && i < rank; i++) {
        json_int_t extent = json_integer_value(json_array_get(list, i));
        good = extent >= 1 && extent <= INT32_MAX;
        out[i] = good ? (uint64_t)extent : 0;
    }
    return good ? CONUS_OK : fail(CONUS_ERROR_DATA, "%s: %zu whole numbers from 1 to 2147483647 are needed", key, rank);
}

static conus_status read_shape(struct zarr_array *out, const json_t *root)
{
    const json_t *shape = json_object_get(root, "shape");
    out->rank = json_array_size(shape);
    if (out->rank < 3 || out->rank > ZARR_AXES) {
        return fail(CONUS_ERROR_DATA, "shape: found %zu axes, allowed are 3 to %d", out->rank, ZARR_AXES);
    }
    return read_extents(out->shape, shape, out->rank, "shape");
}

/* "uint32" of version 3, "<u4" of version 2, which gives the byte order, too. */
static conus_status read_type(struct zarr_array *out, const json_t *value)
{
    static const struct {
        const char *name;
        char kind;
        uint8_t size;
    } types[] = {{"uint8", 'u', 1}, {"uint16", 'u', 2}, {"uint32", 'u', 4}, {"uint64", 'u', 8},  {"int8", 'i', 1},
                 {"int16", 'i', 2}, {"int32", 'i', 4},  {"int64", 'i', 8},  {"float32", 'f', 4}, {"float64", 'f', 8}};
    const char *name = text_of(value);
    bool old = out->format == 2 && strlen(name) == 3 && strchr("<>|", name[0]);
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        bool is = old ? name[1] == types[i].kind && name[2] == '0' + types[i].size && (name[0] != '|' || name[2] == '1')
                      : out->format == 3 && strcmp(name, types[i].name) == 0;
        if (is) {
            out->kind = types[i].kind;
            out->size = types[i].size;
            out->chain.swapped = old && name[0] == '>' ? BIG_ENDIAN_IS_SWAPPED : old && !BIG_ENDIAN_IS_SWAPPED;
            return CONUS_OK;
        }
    }
    return refuse(out->format == 2 ? "dtype" : "data_type", name, "int8 to uint64, float32 and float64");
}

/* "0x7fc00000": the bits of a number of floating point, two digits a byte. */
static bool find_hexadecimal(uint64_t *bits, const char *name, size_t size)
{
    size_t digits = strlen(name) - 2;
    bool good = digits == 2 * size && strspn(name + 2, "0123456789abcdefABCDEF") == digits;
    *bits = good ? strtoull(name + 2, NULL, 16) : 0;
    return good;
}

/* The bits of the fill value; false where it is none of the type's. */
static bool find_fill(uint64_t *bits, const struct zarr_array *array, const json_t *value)
{
    const char *name = text_of(value);
    if (array->kind == 'f' && array->format == 3 && strncmp(name, "0x", 2) == 0) {
        return find_hexadecimal(bits, name, array->size);
    }
    double number = json_is_number(value)            ? json_number_value(value)
                    : strcmp(name, "NaN") == 0       ? NAN
                    : strcmp(name, "Infinity") == 0  ? INFINITY
                    : strcmp(name, "-Infinity") == 0 ? -INFINITY
                                                     : 0;
    if (!json_is_number(value) && (!name[0] || number == 0)) {
        return false;
    }
    if (array->kind == 'f') {
        float narrow = (float)number;
        uint32_t narrow_bits;
        memcpy(&narrow_bits, &narrow, sizeof narrow_bits);
        memcpy(bits, &number, sizeof *bits);
        *bits = array->size == sizeof narrow ? narrow_bits : *bits;
        return true;
    }
    double end = ldexp(1, (int)(8 * array->size) - (array->kind == 'i'));
    bool fits = number == floor(number) && number >= (array->kind == 'i' ? -end : 0) && number < end;
    *bits = !fits                    ? 0
            : json_is_integer(value) ? (uint64_t)json_integer_value(value)
            : number < 0             ? (uint64_t)(int64_t)number
                                     : (uint64_t)number;
    return fits;
}

static conus_status read_fill(struct zarr_array *out, const json_t *value)
{
    uint64_t bits = 0;
    if (out->format == 2 && json_is_null(value)) {
        return CONUS_OK;
    }
    if (!find_fill(&bits, out, value)) {
        return fail(CONUS_ERROR_DATA, "fill_value: a number of the array's type is needed");
    }
    bool big = out->chain.swapped == BIG_ENDIAN_IS_SWAPPED;
    for (size_t i = 0; i < out->size; i++) {
        out->fill[i] = (uint8_t)(bits >> 8 * (big ? out->size - 1 - i : i));
    }
    out->has_fill = true;
    return CONUS_OK;
}

static const char packings_allowed[] = "zstd, gzip, zlib, blosc and crc32c";

/* Appends a packing. Only one may compress, so that the bytes between two are known. */
static conus_status add_packing(struct zarr_chain *chain, const char *name, const char *key)
{
    static const char *const names[] = {[ZARR_ZSTD] = "zstd",
                                        [ZARR_GZIP] = "gzip",
                                        [ZARR_ZLIB] = "zlib",
                                        [ZARR_BLOSC] = "blosc",
                                        [ZARR_CRC32C] = "crc32c"};
    size_t packing = 0;
    while (packing < sizeof names / sizeof names[0] && strcmp(names[packing], name) != 0) {
        packing++;
    }
    if (packing == sizeof names / sizeof names[0]) {
        return refuse(key, name, packings_allowed);
    }
    bool second = false;
    for (size_t i = 0; i < chain->count; i++) {
        second = second || (chain->packings[i] != ZARR_CRC32C && packing != ZARR_CRC32C);
    }
    if (second || chain->count == ZARR_CODECS) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s: a second compression, %s: one is allowed", key, names[packing]);
    }
    chain->packings[chain->count++] = (enum zarr_packing)packing;
    return CONUS_OK;
}

static conus_status add_transpose(struct zarr_chain *chain, size_t rank, const json_t *order)
{
    uint8_t before[ZARR_AXES];
    bool used[ZARR_AXES] = {false};
    memcpy(before, chain->order, sizeof before);
    for (size_t i = 0; i < rank; i++) {
        const json_t *axis = json_array_get(order, i);
        json_int_t at = json_is_integer(axis) ? json_integer_value(axis) : -1;
        if (json_array_size(order) != rank || at < 0 || at >= (json_int_t)rank || used[at]) {
            return fail(CONUS_ERROR_DATA, "codecs: transpose: order: each of the %zu axes is needed once", rank);
        }
        used[at] = true;
        chain->order[i] = before[at];
    }
    return CONUS_OK;
}

static conus_status read_order(struct zarr_chain *chain, size_t size, const json_t *configuration)
{
    const char *endian = text_of(json_object_get(configuration, "endian"));
    bool big = strcmp(endian, "big") == 0;
    chain->swapped = big == BIG_ENDIAN_IS_SWAPPED;
    return size == 1 || big || strcmp(endian, "little") == 0
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "codecs: bytes: endian: little or big is needed");
}

/* Reads a list of codecs: any of transpose, then one of bytes and sharding_indexed, then packings. *sharding is the
 * configuration of the latter, or NULL. */
static conus_status read_chain(struct zarr_chain *out, const json_t **sharding, const json_t *list, size_t rank,
                               size_t size, const char *key)
{
    struct zarr_chain chain = {.count = 0};
    conus_status status = CONUS_OK;
    bool is_bytes = false; /* as packings take them */
    *sharding = NULL;
    for (size_t i = 0; i < ZARR_AXES; i++) {
        chain.order[i] = (uint8_t)i;
    }
    for (size_t i = 0; !status && i < json_array_size(list); i++) {
        const json_t *configuration;
        const char *name = name_of(&configuration, json_array_get(list, i));
        if (is_bytes) {
            status = *sharding ? refuse(key, name, "none behind sharding_indexed") : add_packing(&chain, name, key);
        } else if (strcmp(name, "transpose") == 0) {
            status = add_transpose(&chain, rank, json_object_get(configuration, "order"));
        } else if (strcmp(name, "bytes") == 0) {
            status = read_order(&chain, size, configuration);
            is_bytes = true;
        } else if (strcmp(name, "sharding_indexed") == 0 && json_is_object(configuration) && i == 0) {
            *sharding = configuration;
            is_bytes = true;
        } else {
            status = refuse(key, name, "transpose, bytes and, alone, sharding_indexed");
        }
    }
    if (!status && !is_bytes) {
        return fail(CONUS_ERROR_DATA, "%s: bytes or sharding_indexed is needed", key);
    }
    *out = status ? *out : chain;
    return status;
}

static conus_status read_sharding(struct zarr_array *out, const json_t *sharding)
{
    const json_t *nested = NULL;
    const json_t *location = json_object_get(sharding, "index_location");
    out->sharded = true;
    out->index_first = strcmp(text_of(location), "start") == 0;
    if (location && !out->index_first && strcmp(text_of(location), "end") != 0) {
        return refuse("index_location", text_of(location), "start and end");
    }
    conus_status status = read_extents(out->chunk, json_object_get(sharding, "chunk_shape"), out->rank, "chunk_shape");
    for (size_t i = 0; !status && i < out->rank; i++) {
        if (out->file_chunk[i] % out->chunk[i]) {
            return fail(CONUS_ERROR_DATA, "chunk_shape: %llu does not divide the %llu of a shard",
                        (unsigned long long)out->chunk[i], (unsigned long long)out->file_chunk[i]);
        }
    }
    status = status ? status
                    : read_chain(&out->chain, &nested, json_object_get(sharding, "codecs"), out->rank, out->size,
                                 "codecs in a shard");
    if (!status && nested) {
        return fail(CONUS_ERROR_UNSUPPORTED, "codecs: a shard in a shard");
    }
    status = status ? status
                    : read_chain(&out->index, &nested, json_object_get(sharding, "index_codecs"), 2, sizeof(uint64_t),
                                 "index_codecs");
    bool plain = !nested && out->index.order[0] == 0;
    for (size_t i = 0; !status && i < out->index.count; i++) {
        plain = plain && out->index.packings[i] == ZARR_CRC32C; /* else its size would not be known */
    }
    return status || plain ? status : fail(CONUS_ERROR_UNSUPPORTED, "index_codecs: allowed are bytes and crc32c");
}

/* An object that nobody must understand may stand anywhere; of the two that are known, one changes nothing. */
static conus_status check_members(const json_t *root)
{
    static const char *const known[] = {"zarr_format",          "node_type",  "shape",  "data_type",  "chunk_grid",
                                        "chunk_key_encoding",   "fill_value", "codecs", "attributes", "dimension_names",
                                        "consolidated_metadata"};
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)root, key, value)
    {
        bool fine = json_is_false(json_object_get(value, "must_understand")) ||
                    (strcmp(key, "storage_transformers") == 0 && json_is_array(value) && !json_array_size(value));
        for (size_t i = 0; !fine && i < sizeof known / sizeof known[0]; i++) {
            fine = strcmp(known[i], key) == 0;
        }
        if (!fine) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%.*s: an extension that is not known", ZARR_NAME, key);
        }
    }
    return CONUS_OK;
}

static conus_status read_keys(struct zarr_array *out, const json_t *encoding, const char *fallback)
{
    const json_t *configuration;
    const char *name = name_of(&configuration, encoding);
    const json_t *separator = json_object_get(out->format == 2 ? encoding : configuration,
                                              out->format == 2 ? "dimension_separator" : "separator");
    out->prefixed = out->format == 3 && strcmp(name, "default") == 0;
    if (out->format == 3 && !out->prefixed && strcmp(name, "v2") != 0) {
        return refuse("chunk_key_encoding", name, "default and v2");
    }
    const char *text = separator ? text_of(separator) : out->prefixed ? "/" : fallback;
    out->separator = text[0];
    return strcmp(text, "/") == 0 || strcmp(text, ".") == 0 ? CONUS_OK : refuse("separator", text, "/ and .");
}

static conus_status read_three(struct zarr_array *out, const json_t *root)
{
    const json_t *configuration;
    const json_t *sharding = NULL;
    const char *grid = name_of(&configuration, json_object_get(root, "chunk_grid"));
    conus_status status = check_members(root);
    status = status ? status : read_type(out, json_object_get(root, "data_type"));
    if (!status && strcmp(grid, "regular") != 0) {
        status = refuse("chunk_grid", grid, "regular");
    }
    status =
        status ? status
               : read_extents(out->file_chunk, json_object_get(configuration, "chunk_shape"), out->rank, "chunk_shape");
    memcpy(out->chunk, out->file_chunk, sizeof out->chunk);
    status = status ? status : read_keys(out, json_object_get(root, "chunk_key_encoding"), ".");
    status = status
                 ? status
                 : read_chain(&out->chain, &sharding, json_object_get(root, "codecs"), out->rank, out->size, "codecs");
    return status || !sharding ? status : read_sharding(out, sharding);
}

static conus_status read_two(struct zarr_array *out, const json_t *root)
{
    const json_t *compressor = json_object_get(root, "compressor");
    const json_t *filters = json_object_get(root, "filters");
    const char *order = text_of(json_object_get(root, "order"));
    bool columns = strcmp(order, "F") == 0; /* the first axis is the fastest */
    if (!columns && strcmp(order, "C") != 0) {
        return refuse("order", order, "C and F");
    }
    if (filters && !json_is_null(filters) && json_array_size(filters)) {
        return refuse("filters", text_of(json_object_get(json_array_get(filters, 0), "id")), "none");
    }
    conus_status status = read_type(out, json_object_get(root, "dtype"));
    status = status ? status : read_extents(out->file_chunk, json_object_get(root, "chunks"), out->rank, "chunks");
    memcpy(out->chunk, out->file_chunk, sizeof out->chunk);
    for (size_t i = 0; i < out->rank; i++) {
        out->chain.order[i] = (uint8_t)(columns ? out->rank - 1 - i : i);
    }
    status = status ? status : read_keys(out, root, ".");
    return status || !compressor || json_is_null(compressor)
               ? status
               : add_packing(&out->chain, text_of(json_object_get(compressor, "id")), "compressor");
}

/* Checks that bytes and files can be counted. */
static conus_status count_all(struct zarr_array *out)
{
    size_t bytes = out->size;
    size_t entries = 2 * sizeof(uint64_t);
    size_t files = 1;
    bool fits = true;
    for (size_t i = 0; fits && i < out->rank; i++) {
        fits = memory_multiply(bytes, (size_t)out->chunk[i], &bytes) &&
               memory_multiply(entries, (size_t)(out->file_chunk[i] / out->chunk[i]), &entries) &&
               memory_multiply(files, (size_t)((out->shape[i] + out->file_chunk[i] - 1) / out->file_chunk[i]), &files);
    }
    out->chunk_bytes = bytes;
    return fits && bytes <= INT64_MAX / 2 && entries <= INT64_MAX / 2 && files <= INT32_MAX
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "chunk_shape: more than 2^31 chunks, or a chunk of more than 2^62 bytes");
}

conus_status zarr_array_parse(struct zarr_array *out, struct text text)
{
    json_t *root = NULL;
    struct zarr_array array = {0};
    conus_status status = json_text_load(&root, text);
    if (!status) {
        array.format = (int)json_integer_value(json_object_get(root, "zarr_format"));
        bool is_group = array.format == 3 && strcmp(text_of(json_object_get(root, "node_type")), "array") != 0;
        status = (array.format != 2 && array.format != 3) || is_group
                     ? fail(CONUS_ERROR_DATA, "zarr_format: no array of Zarr 2 or 3")
                     : read_shape(&array, root);
        status = status ? status : array.format == 3 ? read_three(&array, root) : read_two(&array, root);
        status = status ? status : read_fill(&array, json_object_get(root, "fill_value"));
        status = status ? status : count_all(&array);
    }
    json_decref(root);
    *out = status ? *out : array;
    return status;
}
