/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A stack of pages in a TIFF or BigTIFF file: strips or tiles, plain, LZW or deflate, one number a pixel. All of a
 * file's directories are checked against its size before anything is allocated for its pixels. */
#ifndef CONUS_LOADERS_TIFF_TIFF_H
#define CONUS_LOADERS_TIFF_TIFF_H

#include "base/files/file.h"
#include "loaders/tiff/tiff_directory.h"

enum { TIFF_PAGE_LIMIT = 1 << 16 };

struct tiff {
    struct tiff_file file;
    struct tiff_page *pages; /**< Of one size and type. */
    size_t page_count, page_capacity;
    uint64_t depth;      /**< Pages in the stack: page_count, or what ImageJ says where it has one directory for all. */
    uint64_t page_bytes; /**< Unpacked. */
    bool whole;          /**< The pages lie plain and in order, without a gap, from `start` on. */
    uint64_t start;
};

/** True where @p data begins like TIFF or BigTIFF of either byte order. */
bool tiff_is(const uint8_t *data, size_t size);

/** Reads the directories of @p data, a whole file that must outlive @p out; end it with tiff_finish(). Errors name page
 * and field. A stack that its file could not possibly hold is CONUS_ERROR_DATA. */
conus_status tiff_parse(struct tiff *out, const uint8_t *data, size_t size);
void tiff_finish(struct tiff *tiff);

/** Unpacks all pages, one behind the other, rows from the top, in the byte order of the file: depth * page_bytes bytes.
 * @p out is the caller's to finish. */
conus_status tiff_unpack(struct bytes *out, const struct tiff *tiff);

#endif
