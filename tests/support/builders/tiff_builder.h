/* SPDX-License-Identifier: BSD-3-Clause */
/** @file TIFF files of one strip a page, built in memory so that every field can be changed. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_TIFF_BUILDER_H
#define CONUS_TESTS_SUPPORT_BUILDERS_TIFF_BUILDER_H

#include "base/buffer.h"
#include "base/files/file.h"

#include <stdint.h>

enum tiff_tag {
    TAG_SUBFILE = 254,
    TAG_WIDTH = 256,
    TAG_LENGTH = 257,
    TAG_BITS = 258,
    TAG_COMPRESSION = 259,
    TAG_PHOTOMETRIC = 262,
    TAG_DESCRIPTION = 270,
    TAG_OFFSETS = 273,
    TAG_ORIENTATION = 274,
    TAG_SAMPLES = 277,
    TAG_ROWS = 278,
    TAG_COUNTS = 279,
    TAG_PLANAR = 284,
    TAG_PREDICTOR = 317,
    TAG_TILE_WIDTH = 322,
    TAG_TILE_LENGTH = 323,
    TAG_TILE_OFFSETS = 324,
    TAG_TILE_COUNTS = 325,
    TAG_FORMAT = 339,
    TAG_DEPTH = 32997
};

/** A field that replaces the page's field of this tag, or is added. */
struct tiff_field {
    uint16_t tag;
    uint64_t value;
    uint16_t type;  /**< 0 = LONG. */
    uint64_t count; /**< 0 = 1. */
    bool missing;   /**< The page does not have it. */
    bool twice;     /**< It follows on the page's own. */
};

struct tiff_builder {
    struct buffer bytes;
    bool big_endian;
    bool big;         /**< BigTIFF. */
    size_t link;      /**< Where the offset of the next directory belongs. */
    size_t directory; /**< Where the last one is. */
};

/** The header; end with buffer_finish(&builder->bytes). */
void tiff_begin(struct tiff_builder *builder, bool big_endian, bool big);

/** Appends @p data as the strip of a page of 4 x 3 pixels of 8 bits, unless @p fields say otherwise, and its directory.
 */
void tiff_add_page(struct tiff_builder *builder, const void *data, size_t size, const struct tiff_field *fields,
                   size_t count);

/** Links the last directory to the one at @p offset. */
void tiff_link(struct tiff_builder *builder, uint64_t offset);

/** Puts an offset of the file's own size at @p at. */
void tiff_put(struct tiff_builder *builder, size_t at, uint64_t value);

/** Unpacks the one page of a file with these packed bytes, as tiff_unpack() does. */
conus_status tiff_read_page(struct bytes *out, const void *packed, size_t size, const struct tiff_field *fields,
                            size_t count);

#endif
