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

static void refuse(struct job *job, const char *key, const char *found, const char *allowed)
{
    job_refuse(job, "%s: found \"%.*s\", allowed are %s", key, ZARR_NAME, found, allowed);
}

/* 1 after a failure. */
static void read_extents(struct job *job, uint64_t out[ZARR_AXES], const json_t *list, size_t rank, const char *key)
{
    bool good = json_is_array(list) && json_array_size(list) == rank;
    for (size_t i = 0; good && i < rank; i++) {
        json_int_t extent = json_integer_value(json_array_get(list, i));
        good = extent >= 1 && extent <= INT32_MAX;
        out[i] = good ? (uint64_t)extent : 1;
    }
    if (!good) {
        job_bad(job, "%s: %zu whole numbers from 1 to 2147483647 are needed", key, rank);
    }
}

static void read_shape(struct job *job, struct zarr_array *out, const json_t *root)
{
    const json_t *shape = json_object_get(root, "shape");
    out->rank = json_array_size(shape);
    if (out->rank < 3 || out->rank > ZARR_AXES) {
        job_bad(job, "shape: found %zu axes, allowed are 3 to %d", out->rank, ZARR_AXES);
        out->rank = 3;
    }
    read_extents(job, out->shape, shape, out->rank, "shape");
}

/* "uint32" of version 3, "<u4" of version 2, which gives the byte order, too. */
static void read_type(struct job *job, struct zarr_array *out, const json_t *value)
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
            return;
        }
    }
    refuse(job, out->format == 2 ? "dtype" : "data_type", name, "int8 to uint64, float32 and float64");
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

static void read_fill(struct job *job, struct zarr_array *out, const json_t *value)
{
    uint64_t bits = 0;
    if (!job_ok(job) || (out->format == 2 && json_is_null(value))) { /* there may be no type */
        return;
    }
    if (!find_fill(&bits, out, value)) {
        job_bad(job, "fill_value: a number of the array's type is needed");
    }
    bool big = out->chain.swapped == BIG_ENDIAN_IS_SWAPPED;
    for (size_t i = 0; i < out->size; i++) {
        out->fill[i] = (uint8_t)(bits >> 8 * (big ? out->size - 1 - i : i));
    }
    out->has_fill = true;
}

static const char packings_allowed[] = "zstd, gzip, zlib, blosc and crc32c";

/* Appends a packing. Only one may compress, so that the bytes between two are known. */
static void add_packing(struct job *job, struct zarr_chain *chain, const char *name, const char *key)
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
        refuse(job, key, name, packings_allowed);
        return;
    }
    bool second = false;
    for (size_t i = 0; i < chain->count; i++) {
        second = second || (chain->packings[i] != ZARR_CRC32C && packing != ZARR_CRC32C);
    }
    if (second || chain->count == ZARR_CODECS) {
        job_refuse(job, "%s: a second compression, %s: one is allowed", key, names[packing]);
        return;
    }
    chain->packings[chain->count++] = (enum zarr_packing)packing;
}

static void add_transpose(struct job *job, struct zarr_chain *chain, size_t rank, const json_t *order)
{
    uint8_t before[ZARR_AXES];
    bool used[ZARR_AXES] = {false};
    memcpy(before, chain->order, sizeof before);
    for (size_t i = 0; i < rank; i++) {
        const json_t *axis = json_array_get(order, i);
        json_int_t at = json_is_integer(axis) ? json_integer_value(axis) : -1;
        if (json_array_size(order) != rank || at < 0 || at >= (json_int_t)rank || used[at]) {
            job_bad(job, "codecs: transpose: order: each of the %zu axes is needed once", rank);
            return;
        }
        used[at] = true;
        chain->order[i] = before[at];
    }
}

static void read_order(struct job *job, struct zarr_chain *chain, size_t size, const json_t *configuration)
{
    const char *endian = text_of(json_object_get(configuration, "endian"));
    bool big = strcmp(endian, "big") == 0;
    chain->swapped = big == BIG_ENDIAN_IS_SWAPPED;
    if (size != 1 && !big && strcmp(endian, "little") != 0) {
        job_bad(job, "codecs: bytes: endian: little or big is needed");
    }
}

/* Reads a list of codecs: any of transpose, then one of bytes and sharding_indexed, then packings. Gives the
 * configuration of the latter, or NULL. */
static const json_t *read_chain(struct job *job, struct zarr_chain *chain, const json_t *list, size_t rank, size_t size,
                                const char *key)
{
    const json_t *sharding = NULL;
    bool is_bytes = false; /* as packings take them */
    *chain = (struct zarr_chain){.count = 0};
    for (size_t i = 0; i < ZARR_AXES; i++) {
        chain->order[i] = (uint8_t)i;
    }
    for (size_t i = 0; job_ok(job) && i < json_array_size(list); i++) {
        const json_t *configuration;
        const char *name = name_of(&configuration, json_array_get(list, i));
        if (is_bytes && sharding) {
            refuse(job, key, name, "none behind sharding_indexed");
        } else if (is_bytes) {
            add_packing(job, chain, name, key);
        } else if (strcmp(name, "transpose") == 0) {
            add_transpose(job, chain, rank, json_object_get(configuration, "order"));
        } else if (strcmp(name, "bytes") == 0) {
            read_order(job, chain, size, configuration);
            is_bytes = true;
        } else if (strcmp(name, "sharding_indexed") == 0 && json_is_object(configuration) && i == 0) {
            sharding = configuration;
            is_bytes = true;
        } else {
            refuse(job, key, name, "transpose, bytes and, alone, sharding_indexed");
        }
    }
    if (!is_bytes) {
        job_bad(job, "%s: bytes or sharding_indexed is needed", key);
    }
    return job_ok(job) ? sharding : NULL;
}

static void read_sharding(struct job *job, struct zarr_array *out, const json_t *sharding)
{
    const json_t *location = json_object_get(sharding, "index_location");
    out->sharded = true;
    out->index_first = strcmp(text_of(location), "start") == 0;
    if (location && !out->index_first && strcmp(text_of(location), "end") != 0) {
        refuse(job, "index_location", text_of(location), "start and end");
    }
    read_extents(job, out->chunk, json_object_get(sharding, "chunk_shape"), out->rank, "chunk_shape");
    for (size_t i = 0; job_ok(job) && i < out->rank; i++) {
        if (out->file_chunk[i] % out->chunk[i]) {
            job_bad(job, "chunk_shape: %llu does not divide the %llu of a shard", (unsigned long long)out->chunk[i],
                    (unsigned long long)out->file_chunk[i]);
        }
    }
    if (read_chain(job, &out->chain, json_object_get(sharding, "codecs"), out->rank, out->size, "codecs in a shard")) {
        job_refuse(job, "codecs: a shard in a shard");
    }
    bool plain =
        !read_chain(job, &out->index, json_object_get(sharding, "index_codecs"), 2, sizeof(uint64_t), "index_codecs") &&
        out->index.order[0] == 0;
    for (size_t i = 0; i < out->index.count; i++) {
        plain = plain && out->index.packings[i] == ZARR_CRC32C; /* else its size would not be known */
    }
    if (!plain) {
        job_refuse(job, "index_codecs: allowed are bytes and crc32c");
    }
}

/* An object that nobody must understand may stand anywhere; of the two that are known, one changes nothing. */
static void check_members(struct job *job, const json_t *root)
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
            job_refuse(job, "%.*s: an extension that is not known", ZARR_NAME, key);
        }
    }
}

static void read_keys(struct job *job, struct zarr_array *out, const json_t *encoding, const char *fallback)
{
    const json_t *configuration;
    const char *name = name_of(&configuration, encoding);
    const json_t *separator = json_object_get(out->format == 2 ? encoding : configuration,
                                              out->format == 2 ? "dimension_separator" : "separator");
    out->prefixed = out->format == 3 && strcmp(name, "default") == 0;
    if (out->format == 3 && !out->prefixed && strcmp(name, "v2") != 0) {
        refuse(job, "chunk_key_encoding", name, "default and v2");
    }
    const char *text = separator ? text_of(separator) : out->prefixed ? "/" : fallback;
    out->separator = text[0];
    if (strcmp(text, "/") != 0 && strcmp(text, ".") != 0) {
        refuse(job, "separator", text, "/ and .");
    }
}

static void read_three(struct job *job, struct zarr_array *out, const json_t *root)
{
    const json_t *configuration;
    const char *grid = name_of(&configuration, json_object_get(root, "chunk_grid"));
    check_members(job, root);
    read_type(job, out, json_object_get(root, "data_type"));
    if (strcmp(grid, "regular") != 0) {
        refuse(job, "chunk_grid", grid, "regular");
    }
    read_extents(job, out->file_chunk, json_object_get(configuration, "chunk_shape"), out->rank, "chunk_shape");
    memcpy(out->chunk, out->file_chunk, sizeof out->chunk);
    read_keys(job, out, json_object_get(root, "chunk_key_encoding"), ".");
    const json_t *sharding =
        read_chain(job, &out->chain, json_object_get(root, "codecs"), out->rank, out->size, "codecs");
    if (sharding) {
        read_sharding(job, out, sharding);
    }
}

static void read_two(struct job *job, struct zarr_array *out, const json_t *root)
{
    const json_t *compressor = json_object_get(root, "compressor");
    const json_t *filters = json_object_get(root, "filters");
    const char *order = text_of(json_object_get(root, "order"));
    bool columns = strcmp(order, "F") == 0; /* the first axis is the fastest */
    if (!columns && strcmp(order, "C") != 0) {
        refuse(job, "order", order, "C and F");
    }
    if (filters && !json_is_null(filters) && json_array_size(filters)) {
        refuse(job, "filters", text_of(json_object_get(json_array_get(filters, 0), "id")), "none");
    }
    read_type(job, out, json_object_get(root, "dtype"));
    read_extents(job, out->file_chunk, json_object_get(root, "chunks"), out->rank, "chunks");
    memcpy(out->chunk, out->file_chunk, sizeof out->chunk);
    for (size_t i = 0; i < out->rank; i++) {
        out->chain.order[i] = (uint8_t)(columns ? out->rank - 1 - i : i);
    }
    read_keys(job, out, root, ".");
    if (compressor && !json_is_null(compressor)) {
        add_packing(job, &out->chain, text_of(json_object_get(compressor, "id")), "compressor");
    }
}

static void count_all(struct job *job, struct zarr_array *out)
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
    if (!fits || bytes > INT64_MAX / 2 || entries > INT64_MAX / 2 || files > INT32_MAX) {
        job_bad(job, "chunk_shape: more than 2^31 chunks, or a chunk of more than 2^62 bytes");
    }
}

void zarr_array_parse(struct job *job, struct zarr_array *out, struct text text)
{
    json_t *root = NULL;
    *out = (struct zarr_array){0};
    if (!JOB_CALL(job, json_text_load(&root, text))) {
        json_decref(root);
        return;
    }
    out->format = (int)json_integer_value(json_object_get(root, "zarr_format"));
    bool is_group = out->format == 3 && strcmp(text_of(json_object_get(root, "node_type")), "array") != 0;
    if ((out->format != 2 && out->format != 3) || is_group) {
        job_bad(job, "zarr_format: no array of Zarr 2 or 3");
    }
    read_shape(job, out, root);
    (out->format == 3 ? read_three : read_two)(job, out, root);
    read_fill(job, out, json_object_get(root, "fill_value"));
    if (job_ok(job)) {
        count_all(job, out);
    }
    json_decref(root);
}
