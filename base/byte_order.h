/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Bytes of a file: numbers of either byte order, and how gzip begins. */
#ifndef CONUS_BASE_BYTE_ORDER_H
#define CONUS_BASE_BYTE_ORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Numbers of either byte order out of unaligned bytes, and into them, the lowest byte first. `swapped` = not this
 * machine's order. */

/** Whether big-endian data are swapped here. */
#define BIG_ENDIAN_IS_SWAPPED (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)

static inline uint16_t order_u16(const uint8_t *data, bool swapped)
{
    uint16_t value;
    memcpy(&value, data, sizeof value);
    return swapped ? __builtin_bswap16(value) : value;
}

static inline uint32_t order_u32(const uint8_t *data, bool swapped)
{
    uint32_t value;
    memcpy(&value, data, sizeof value);
    return swapped ? __builtin_bswap32(value) : value;
}

static inline uint64_t order_u64(const uint8_t *data, bool swapped)
{
    uint64_t value;
    memcpy(&value, data, sizeof value);
    return swapped ? __builtin_bswap64(value) : value;
}

static inline int16_t order_i16(const uint8_t *data, bool swapped)
{
    return (int16_t)order_u16(data, swapped);
}

static inline int32_t order_i32(const uint8_t *data, bool swapped)
{
    return (int32_t)order_u32(data, swapped);
}

static inline int64_t order_i64(const uint8_t *data, bool swapped)
{
    return (int64_t)order_u64(data, swapped);
}

static inline float order_f32(const uint8_t *data, bool swapped)
{
    uint32_t bits = order_u32(data, swapped);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline double order_f64(const uint8_t *data, bool swapped)
{
    uint64_t bits = order_u64(data, swapped);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/** The whole number of @p size bytes (1, 2, 4, 8); an unsigned one of 8 comes as the same bits. */
static inline int64_t order_whole(const uint8_t *data, size_t size, bool is_signed, bool swapped)
{
    switch (size) {
    case 1:
        return is_signed ? (int8_t)*data : *data;
    case 2:
        return is_signed ? order_i16(data, swapped) : order_u16(data, swapped);
    case 4:
        return is_signed ? (int64_t)order_i32(data, swapped) : (int64_t)order_u32(data, swapped);
    default:
        return order_i64(data, swapped);
    }
}

/** The floating-point number of @p size bytes (4, 8). */
static inline double order_real(const uint8_t *data, size_t size, bool swapped)
{
    return size == 4 ? (double)order_f32(data, swapped) : order_f64(data, swapped);
}

/** Writes the @p size lowest bytes of @p value, the lowest first. */
static inline void order_put(uint8_t *to, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        to[i] = (uint8_t)(value >> 8 * i);
    }
}

static inline void order_put_f32(uint8_t *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    order_put(to, bits, sizeof bits);
}

/* How a file of gzip begins: also for the reader, which packs nothing out by base/formats/. */

/** The smaller of two numbers of bytes, which fits into a size. */
static inline size_t smaller_of(uint64_t a, uint64_t b)
{
    return (size_t)(a < b ? a : b);
}

/** True where @p data begins like a gzip file. */
bool gzip_is(const uint8_t *data, size_t size);

#endif
