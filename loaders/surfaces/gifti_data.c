/* SPDX-License-Identifier: BSD-3-Clause */
/* Decodes the numbers of a GIFTI array: text, base64, packed base64, or another file. */
#include "loaders/surfaces/gifti_data.h"

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/base64.h"
#include "base/formats/gzip.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <libdeflate.h>

enum { INFLATE_RATIO = 1032, SHOWN = 20 };

static size_t size_of(enum gifti_type type)
{
    switch (type) {
    case GIFTI_UINT8:
    case GIFTI_INT8:
        return 1;
    case GIFTI_INT16:
    case GIFTI_UINT16:
        return 2;
    case GIFTI_INT32:
    case GIFTI_UINT32:
    case GIFTI_FLOAT32:
        return 4;
    default:
        return 8;
    }
}

static double number_at(const uint8_t *data, enum gifti_type type, bool swapped)
{
    switch (type) {
    case GIFTI_UINT8:
        return data[0];
    case GIFTI_INT8:
        return (int8_t)data[0];
    case GIFTI_INT16:
        return order_i16(data, swapped);
    case GIFTI_UINT16:
        return order_u16(data, swapped);
    case GIFTI_INT32:
        return order_i32(data, swapped);
    case GIFTI_UINT32:
        return order_u32(data, swapped);
    case GIFTI_FLOAT32:
        return (double)order_f32(data, swapped);
    case GIFTI_FLOAT64:
        return order_f64(data, swapped);
    case GIFTI_INT64:
        return (double)order_i64(data, swapped);
    case GIFTI_UINT64:
        return (double)order_u64(data, swapped);
    }
    return NAN;
}

/* Where the n-th stored number belongs when the last index is to run fastest. */
static size_t place_of(size_t n, const struct gifti_storage *storage)
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
static bool fits_type(double value, enum gifti_type type)
{
    double bits = 8 * (double)size_of(type);
    switch (type) {
    case GIFTI_FLOAT32:
    case GIFTI_FLOAT64:
        return true;
    case GIFTI_UINT8:
    case GIFTI_UINT16:
    case GIFTI_UINT32:
    case GIFTI_UINT64:
        return value == floor(value) && value >= 0 && value < exp2(bits);
    default:
        return value == floor(value) && value >= -exp2(bits - 1) && value < exp2(bits - 1);
    }
}

static conus_status decode_ascii(double *values, const struct gifti_storage *storage, struct text text)
{
    struct text word;
    size_t n = 0;
    for (; text_word(&text, &word); n++) {
        double value;
        if (n < storage->count && (!text_to_double(word, &value) || !fits_type(value, storage->type))) {
            return fail(CONUS_ERROR_DATA, "Data: number %zu is \"%.*s\", one of the array's DataType is needed", n,
                        (int)(word.size < SHOWN ? word.size : SHOWN), word.data);
        }
        if (n < storage->count) {
            values[place_of(n, storage)] = value;
        }
    }
    return n == storage->count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "Data: %zu numbers, the Dim attributes ask for %zu", n, storage->count);
}

static bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
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
        if (is_space(text.data[i])) {
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

static enum libdeflate_result inflate_packed(struct libdeflate_decompressor *decompressor, const struct bytes *packed,
                                             uint8_t *out, size_t size, size_t *used, size_t *got)
{
    return gzip_is(packed->data, packed->size) /* what the encoding's name says, and no known program writes */
               ? libdeflate_gzip_decompress_ex(decompressor, packed->data, packed->size, out, size, used, got)
               : libdeflate_zlib_decompress_ex(decompressor, packed->data, packed->size, out, size, used, got);
}

static conus_status inflate_into(struct bytes *unpacked, const struct bytes *packed)
{
    struct libdeflate_decompressor *decompressor = libdeflate_alloc_decompressor();
    if (!decompressor) {
        return fail(CONUS_ERROR_MEMORY, "no memory to unpack");
    }
    size_t used = 0;
    size_t got = 0;
    enum libdeflate_result result = inflate_packed(decompressor, packed, unpacked->data, unpacked->size, &used, &got);
    libdeflate_free_decompressor(decompressor);
    if (result == LIBDEFLATE_INSUFFICIENT_SPACE || (!result && got != unpacked->size)) {
        return fail(CONUS_ERROR_DATA, "Data: unpacks to %s than the %zu bytes that the Dim attributes ask for",
                    result ? "more" : "fewer", unpacked->size);
    }
    if (result || used != packed->size) {
        return fail(CONUS_ERROR_DATA, "Data: %s",
                    result ? "the packed bytes are damaged" : "bytes after the packed ones");
    }
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
    conus_status status = inflate_into(&bytes, packed);
    if (status) {
        bytes_finish(&bytes);
        return status;
    }
    *out = bytes;
    return CONUS_OK;
}

static conus_status read_external(struct bytes *out, const struct gifti_storage *storage, size_t size)
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
        return read_external(out, storage, size);
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

conus_status gifti_data_decode(double **out, const struct gifti_storage *storage, struct text text)
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
        values[place_of(n, storage)] =
            number_at(bytes.data + n * size_of(storage->type), storage->type, storage->swapped);
    }
    bytes_finish(&bytes);
    if (status) {
        memory_free(values);
        return status;
    }
    *out = values;
    return CONUS_OK;
}
