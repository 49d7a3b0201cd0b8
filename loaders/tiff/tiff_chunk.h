/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A strip or tile of a TIFF page, unpacked. */
#ifndef CONUS_LOADERS_TIFF_TIFF_CHUNK_H
#define CONUS_LOADERS_TIFF_TIFF_CHUNK_H

#include "loaders/tiff/tiff_directory.h"

/** What chunks of one file need one after the other; begins zeroed. */
struct tiff_unpacker {
    struct libdeflate_decompressor *deflate;
    struct tiff_lzw *lzw;
};

struct tiff_chunk {
    const uint8_t *packed;
    size_t packed_size;
    uint8_t *out;         /**< [rows * width * bits / 8] */
    uint64_t width, rows; /**< Pixels that are stored. */
};

void tiff_unpacker_finish(struct tiff_unpacker *unpacker);

/** Unpacks @p chunk of @p page, and undoes its differences. Pixels stay in the byte order of the file, which is the
 * other than this machine's where it is @p swapped. Without a message: CONUS_ERROR_DATA where the packed bytes are
 * damaged, or hold fewer or more than the chunk. */
conus_status tiff_chunk_unpack(struct tiff_unpacker *unpacker, const struct tiff_page *page,
                               const struct tiff_chunk *chunk, bool swapped);

#endif
