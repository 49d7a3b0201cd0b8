/* SPDX-License-Identifier: BSD-3-Clause */
/** @file TIFF files of one strip a page, built in memory. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_TIFF_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_TIFF_BUILDER_H

#include "base/memory.h"

#include <stdint.h>

enum tiff_tag {
    TAG_WIDTH = 256,
    TAG_LENGTH = 257,
    TAG_BITS = 258,
    TAG_COMPRESSION = 259,
    TAG_OFFSETS = 273,
    TAG_COUNTS = 279,
};

/** A whole number that replaces the page's field of this tag, or is added. */
struct tiff_field {
    uint16_t tag;
    uint32_t value;
};

struct tiff_builder {
    struct buffer bytes;
    size_t link; /**< Where the offset of the next directory belongs. */
};

/** The header of a little-endian file; end with buffer_finish(&builder->bytes). */
void tiff_begin(struct tiff_builder *builder);

/** Appends @p data as the strip of a page of 4 x 3 pixels of 8 bits, unless @p fields say otherwise, and its directory.
 */
void tiff_add_page(struct tiff_builder *builder, const void *data, size_t size, const struct tiff_field *fields,
                   size_t count);

#endif
