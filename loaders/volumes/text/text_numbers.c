/* SPDX-License-Identifier: BSD-3-Clause */
/* Decodes voxels that are written as text. */
#include "loaders/volumes/text/text_numbers.h"

#include "base/memory.h"
#include "loaders/volumes/text/header_text.h"

#include <float.h>
#include <math.h>
#include <string.h>

static conus_status fail_count(const char *unit, unsigned long long found, unsigned long long wanted)
{
    return fail(CONUS_ERROR_DATA, "voxels: found %llu %s, the header asks for %llu", found, unit, wanted);
}

/* A whole number of `size` bytes, as the low bytes of *bits. */
static bool read_whole(uint64_t *bits, struct text word, struct text_type type)
{
    int64_t number = 0;
    unsigned shift = (unsigned)(8 * (8 - type.size));
    if (type.kind == 'u') {
        return text_to_uint(word, UINT64_MAX >> shift, bits);
    }
    bool fits = text_to_int(word, &number) && number >= INT64_MIN >> shift && number <= INT64_MAX >> shift;
    *bits = (uint64_t)number;
    return fits;
}

static bool read_real(double *out, struct text word, size_t size)
{
    bool fits = text_to_double(word, out);
    return fits && (size == sizeof *out || !isfinite(*out) || fabs(*out) <= (double)FLT_MAX);
}

/* Writes one number as it lies in memory. */
static bool write_number(uint8_t *to, struct text word, struct text_type type)
{
    uint64_t bits = 0;
    double real = 0;
    bool fits = type.kind == 'f' ? read_real(&real, word, type.size) : read_whole(&bits, word, type);
    float single = fits ? (float)real : 0;
    uint32_t half = (uint32_t)bits;
    uint16_t quarter = (uint16_t)bits;
    uint8_t byte = (uint8_t)bits;
    const void *from = type.kind == 'f' ? (type.size == 4 ? (const void *)&single : (const void *)&real)
                       : type.size == 8 ? (const void *)&bits
                       : type.size == 4 ? (const void *)&half
                       : type.size == 2 ? (const void *)&quarter
                                        : (const void *)&byte;
    memcpy(to, from, type.size);
    return fits;
}

conus_status text_numbers_read(struct bytes *out, struct gzip_range *range, struct text text, struct text_type type)
{
    uint64_t wanted = range->total / type.size;
    uint64_t first = range->from / type.size;
    uint64_t last = first + range->count / type.size;
    if (wanted > text.size / 2 + 1) { /* a digit and a space each */
        return fail_count("bytes of numbers", text.size, wanted);
    }
    uint8_t *kept = memory_raw(range->count, 1);
    conus_status status = kept ? CONUS_OK : CONUS_ERROR_MEMORY;
    struct text word;
    uint64_t index = 0;
    for (; !status && text_word(&text, &word); index++) {
        uint8_t other[8];
        bool inside = index >= first && index < last;
        uint8_t *to = inside ? kept + (index - first) * type.size : other;
        if (index < wanted && !write_number(to, word, type)) {
            status = fail(CONUS_ERROR_DATA, "voxels: number %llu: found \"%.*s\", which is none of the type",
                          (unsigned long long)index, HEADER_SHOW(word));
        }
    }
    status = status || index == wanted ? status : fail_count("numbers", index, wanted);
    if (status) {
        memory_free(kept);
        return status;
    }
    *out = (struct bytes){kept, range->count};
    return CONUS_OK;
}

/* 0 to 15, or -1. */
static int digit_of(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

conus_status text_hex_read(struct bytes *out, struct gzip_range *range, struct text text)
{
    if (range->total > text.size / 2) {
        return fail_count("hexadecimal digits at most", text.size, 2 * range->total);
    }
    uint8_t *kept = memory_raw(range->count, 1);
    conus_status status = kept ? CONUS_OK : CONUS_ERROR_MEMORY;
    uint64_t digits = 0;
    unsigned byte = 0;
    for (size_t i = 0; !status && i < text.size; i++) {
        int digit = digit_of(text.data[i]);
        if (digit < 0) {
            bool space = text.data[i] && strchr(" \t\r\n\v\f", text.data[i]);
            status = space ? CONUS_OK : fail(CONUS_ERROR_DATA, "voxels: byte %zu is no hexadecimal digit", i);
            continue;
        }
        byte = byte << 4 | (unsigned)digit;
        uint64_t at = digits++ / 2;
        if (at >= range->from && at - range->from < range->count) {
            kept[at - range->from] = (uint8_t)byte;
        }
    }
    status = status || digits == 2 * range->total ? status : fail_count("hexadecimal digits", digits, 2 * range->total);
    if (status) {
        memory_free(kept);
        return status;
    }
    *out = (struct bytes){kept, range->count};
    return CONUS_OK;
}
