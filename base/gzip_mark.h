/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How a file of gzip begins: also for the reader, which packs nothing out by base/formats/. */
#ifndef CONUS_BASE_GZIP_MARK_H
#define CONUS_BASE_GZIP_MARK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** The smaller of two numbers of bytes, which fits into a size. */
static inline size_t smaller_of(uint64_t a, uint64_t b)
{
    return (size_t)(a < b ? a : b);
}

/** True where @p data begins like a gzip file. */
bool gzip_is(const uint8_t *data, size_t size);

#endif
