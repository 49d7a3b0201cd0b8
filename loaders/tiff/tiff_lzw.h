/* SPDX-License-Identifier: BSD-3-Clause */
/** @file LZW as TIFF 6.0 has it: codes of 9 to 12 bits, the highest bit first. */
#ifndef CONUS_LOADERS_TIFF_TIFF_LZW_H
#define CONUS_LOADERS_TIFF_TIFF_LZW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TIFF_LZW_CODES = 4096 };

/** The strings behind the codes; needs no beginning and no end. */
struct tiff_lzw {
    uint16_t before[TIFF_LZW_CODES]; /**< Code of the string without its last byte. */
    uint16_t length[TIFF_LZW_CODES];
    uint8_t first[TIFF_LZW_CODES], last[TIFF_LZW_CODES];
};

/** Unpacks exactly @p size bytes; false where @p packed is damaged, or holds fewer or more. */
bool tiff_lzw_unpack(uint8_t *out, size_t size, const uint8_t *packed, size_t packed_size, struct tiff_lzw *lzw);

#endif
