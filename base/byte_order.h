/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Numbers of either byte order out of unaligned bytes. `swapped` = not this machine's order. */
#ifndef CONUS_BASE_BYTE_ORDER_H
#define CONUS_BASE_BYTE_ORDER_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

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

#endif
