/* SPDX-License-Identifier: BSD-3-Clause */
/* Decodes a VTP's arrays: text, or a header that counts bytes and the bytes, as they are or in base64, whole or packed
 * in blocks. */
#include "loaders/surfaces/foreign/vtp_data.h"

#include "base/byte_order.h"
#include "base/formats/base64.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/words.h"

#include <libdeflate.h>
#include <math.h>
#include <string.h>

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

static bool take_bytes(uint8_t *out, struct source *source, size_t size)
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
    if (!take_bytes(bytes, source, storage->header)) {
        return false;
    }
    *out = storage->header == 4 ? order_u32(bytes, storage->swapped) : order_u64(bytes, storage->swapped);
    return true;
}

static conus_status fail_cut_off(void)
{
    return fail(CONUS_ERROR_DATA, "DataArray: its data are cut off, or no base64");
}

static conus_status check_size(uint64_t size, const struct vtp_storage *storage)
{
    if (size > storage->max_memory) {
        return fail(CONUS_ERROR_MEMORY, "DataArray: %llu bytes, allowed are %llu (--max-memory)",
                    (unsigned long long)size, (unsigned long long)storage->max_memory);
    }
    return CONUS_OK;
}

/* The size, then the bytes. */
static conus_status read_plain(struct bytes *out, struct source *source, const struct vtp_storage *storage)
{
    uint64_t size;
    if (!take_header(&size, source, storage) || size > bytes_left(source)) {
        return fail_cut_off();
    }
    struct bytes bytes = {memory_raw((size_t)size, 1), (size_t)size};
    if (!bytes.data) {
        return CONUS_ERROR_MEMORY;
    }
    if (!take_bytes(bytes.data, source, bytes.size)) {
        bytes_finish(&bytes);
        return fail_cut_off();
    }
    *out = bytes;
    return CONUS_OK;
}

/* All blocks have `size` bytes, unpacked, but the last one if `last` is not 0. */
struct blocks {
    uint64_t count, size, last;
    uint64_t *packed; /* [count] their sizes, packed; owned */
};

static conus_status read_sizes(struct blocks *out, struct source *source, const struct vtp_storage *storage)
{
    bool there = take_header(&out->count, source, storage);
    if (there && !out->count) {
        return CONUS_OK;
    }
    if (!there || !take_header(&out->size, source, storage) || !take_header(&out->last, source, storage) ||
        out->count > bytes_left(source) / storage->header) {
        return fail_cut_off();
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
            return fail_cut_off();
        }
    }
    return CONUS_OK;
}

static uint64_t size_of_block(const struct blocks *blocks, uint64_t i)
{
    return i + 1 == blocks->count && blocks->last ? blocks->last : blocks->size;
}

/* What all blocks unpack to; refused where the packed bytes are too few for it. */
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
        return fail_cut_off();
    }
    *out = (size_t)all;
    return check_size(all, storage);
}

static conus_status unpack_block(uint8_t *out, size_t size, struct source *source, size_t packed_size)
{
    struct libdeflate_decompressor *unpacker = libdeflate_alloc_decompressor();
    uint8_t *packed = memory_raw(packed_size, 1);
    size_t got = 0;
    size_t used = 0;
    conus_status status = packed && unpacker ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "no memory to unpack");
    if (!status && !take_bytes(packed, source, packed_size)) {
        status = fail_cut_off();
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
    conus_status status = read_sizes(&blocks, source, storage);
    status = status ? status : find_size(&size, &blocks, source, storage);
    status = status ? status : unpack_blocks(out, source, &blocks, size);
    memory_free(blocks.packed);
    return status;
}

conus_status vtp_bytes(struct bytes *out, const struct vtp_storage *storage)
{
    struct source source = {.rest = storage->content, .is_raw = storage->is_raw};
    struct bytes bytes = {0};
    conus_status status =
        storage->is_packed ? read_packed(&bytes, &source, storage) : read_plain(&bytes, &source, storage);
    if (!status && bytes.size % storage->size) {
        status = fail(CONUS_ERROR_DATA, "DataArray: %zu bytes, each number has %zu", bytes.size, storage->size);
    }
    if (status) {
        bytes_finish(&bytes);
        return status;
    }
    *out = bytes;
    return CONUS_OK;
}

static int64_t whole_at(const uint8_t *data, const struct vtp_storage *storage)
{
    bool is_signed = storage->kind == VTP_INTEGER;
    uint64_t wide;
    switch (storage->size) {
    case 1:
        return is_signed ? (int8_t)*data : *data;
    case 2:
        return is_signed ? order_i16(data, storage->swapped) : order_u16(data, storage->swapped);
    case 4:
        return is_signed ? (int64_t)order_i32(data, storage->swapped) : (int64_t)order_u32(data, storage->swapped);
    default:
        wide = order_u64(data, storage->swapped);
        return is_signed || wide <= INT64_MAX ? (int64_t)wide : -1;
    }
}

static float float_at(const uint8_t *data, const struct vtp_storage *storage)
{
    return storage->kind != VTP_REAL ? (float)whole_at(data, storage)
           : storage->size == 4      ? order_f32(data, storage->swapped)
                                     : (float)order_f64(data, storage->swapped);
}

/* How many words the text has. */
static size_t count_words(struct text text)
{
    struct text word;
    size_t count = 0;
    while (text_word(&text, &word)) {
        count++;
    }
    return count;
}

/* What an array becomes: 64-bit whole numbers, or floats. */
struct numbers {
    size_t size;
    conus_status (*read)(void *to, struct words *words);
    void (*take)(void *to, const uint8_t *data, const struct vtp_storage *storage);
};

static conus_status read_whole(void *to, struct words *words)
{
    return words_whole(to, words, INT64_MIN, "a whole number");
}

static conus_status read_float(void *to, struct words *words)
{
    return words_float(to, words, "a number");
}

static conus_status read_any_float(void *to, struct words *words)
{
    return words_any_float(to, words, "a number");
}

static void take_whole(void *to, const uint8_t *data, const struct vtp_storage *storage)
{
    *(int64_t *)to = whole_at(data, storage);
}

static void take_float(void *to, const uint8_t *data, const struct vtp_storage *storage)
{
    *(float *)to = float_at(data, storage);
}

static conus_status numbers_of_text(void **out, size_t *count, const struct vtp_storage *storage,
                                    const struct numbers *kind)
{
    struct words words = {.rest = storage->content, .line = 1};
    size_t n = count_words(words.rest);
    char *numbers = memory_raw(n, kind->size);
    conus_status status = numbers ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < n; i++) {
        status = kind->read(numbers + i * kind->size, &words);
    }
    if (status) {
        memory_free(numbers);
        return fail_in(status, "DataArray");
    }
    *out = numbers;
    *count = n;
    return CONUS_OK;
}

static conus_status numbers_of(void **out, size_t *count, const struct vtp_storage *storage, const struct numbers *kind)
{
    struct bytes bytes = {0};
    if (storage->is_text) {
        return numbers_of_text(out, count, storage, kind);
    }
    conus_status status = vtp_bytes(&bytes, storage);
    size_t n = bytes.size / storage->size;
    char *numbers = status ? NULL : memory_raw(n, kind->size);
    for (size_t i = 0; numbers && i < n; i++) {
        kind->take(numbers + i * kind->size, bytes.data + i * storage->size, storage);
    }
    bytes_finish(&bytes);
    *count = numbers ? n : *count;
    *out = numbers ? numbers : *out;
    return status || numbers ? status : CONUS_ERROR_MEMORY;
}

conus_status vtp_wholes(int64_t **out, size_t *count, const struct vtp_storage *storage)
{
    static const struct numbers wholes = {sizeof(int64_t), read_whole, take_whole};
    void *numbers = NULL;
    conus_status status = numbers_of(&numbers, count, storage, &wholes);
    *out = status ? *out : numbers;
    return status;
}

conus_status vtp_floats(float **out, size_t *count, const struct vtp_storage *storage)
{
    static const struct numbers finite = {sizeof(float), read_float, take_float};
    static const struct numbers any = {sizeof(float), read_any_float, take_float};
    void *numbers = NULL;
    conus_status status = numbers_of(&numbers, count, storage, storage->any ? &any : &finite);
    *out = status ? *out : numbers;
    return status;
}
