/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Points from which a gzip file can be unpacked without the bytes before them. A point is where a block of deflate
 * begins: to go on there takes the position in bits and the window, the 32 KiB that were unpacked before it. The span
 * of a point reaches to the next one, or to the end. A CRC-32 of each span shows whether the bytes that an index leads
 * to are those that were unpacked when it was made; at that time the file's own checksums were verified. */
#ifndef CONUS_BASE_FORMATS_GZIP_INDEX_H
#define CONUS_BASE_FORMATS_GZIP_INDEX_H

#include "base/buffer.h"
#include "base/formats/gzip.h"

enum {
    GZIP_INDEX_SPAN = 1 << 20,   /**< Least number of unpacked bytes in a span, except the last. */
    GZIP_INDEX_POINTS = 512,     /**< Spans are longer if there would be more points, but for two. */
    GZIP_INDEX_WINDOW = 1 << 15, /**< Bytes of an unpacked window, at most.                     */
    GZIP_INDEX_LIMIT = 1 << 25,  /**< Bytes of an index.                                        */
    GZIP_BEFORE_A_BLOCK = 128    /**< Of zlib's data_type: a block of deflate begins here.       */
};

/** A point, in this machine's numbers. */
struct gzip_point {
    uint64_t unpacked;    /**< Bytes of the unpacked file before it.                                    */
    uint64_t packed;      /**< Whole bytes of the packed file before it.                                */
    uint32_t bits;        /**< Last bits of the byte before `packed` that belong to it, 0 to 7.         */
    uint32_t sum;         /**< CRC-32 of its span.                                                      */
    uint32_t window;      /**< Where its window begins, packed by deflate, in gzip_index.windows.       */
    uint32_t window_size; /**< Its packed bytes; 0 = nothing is before it, as at the begin of a member. */
};

/** An index as it is kept; borrowed. */
struct gzip_index {
    uint64_t unpacked; /**< Bytes of the whole file, unpacked. */
    uint64_t packed;   /**< Bytes of the whole file, packed. */
    uint64_t junk;     /**< Bytes, as gzip_range.junk. */
    uint64_t trailer;  /**< Bytes before the checksum of the only member; 0 = there are several, or zlib. */
    uint64_t begin;    /**< Bytes before the stream; 0 = the whole file is packed. */
    bool zlib;         /**< The stream is zlib's (RFC 1950), not gzip. */
    char sha256[65];   /**< The packed file's, in hexadecimal. */
    const struct gzip_point *points; /**< [count], by `unpacked`; the first one is at 0.                */
    size_t count;
    const uint8_t *windows;
    size_t windows_size;
};

/** Finds the parts of the index that @p data, 8-aligned, consists of. False where they contradict each other. */
bool gzip_index_parse(struct gzip_index *out, const uint8_t *data, size_t size);

/** Whether the file's own checksum and size are those that the spans have together. True where there are several
 * members, whose checksums stand in many places, and of zlib, whose checksum is another. */
bool gzip_index_fits(const struct gzip_index *index, int descriptor);

/** Unpacks the bytes of @p range, as gzip_unpack() does and with the same results, from the open file of the index.
 * Unpacked bytes have the checksums of their spans, or CONUS_ERROR_DATA says that index and file do not fit together;
 * what a sink has got is not verified before this has succeeded. CONUS_ERROR_IO where the file cannot be read. */
conus_status gzip_index_unpack(struct bytes *out, struct gzip_range *range, const struct gzip_index *index,
                               int descriptor);

/** The first @p limit unpacked bytes, or fewer where there are not as many, verified alike. */
conus_status gzip_index_head(struct bytes *out, const struct gzip_index *index, size_t limit, int descriptor);

struct libdeflate_compressor;
struct z_stream_s;

/** Makes an index while a file is unpacked. */
struct gzip_indexer {
    uint64_t spacing; /**< Bytes of a span, at least. */
    uint64_t begin;   /**< Where the stream begins in its file: the caller's to set, as zlib. */
    bool zlib;
    struct buffer points, windows;
    uint32_t sum;         /**< CRC-32 of the last span so far. */
    size_t members;       /**< Members that have ended. */
    uint64_t members_end; /**< Packed bytes of these. */
    struct libdeflate_compressor *compressor;
    bool failed; /**< There is no memory for an index: the unpacking goes on without it. */
};

/** For a file that unpacks to about @p total bytes. */
void gzip_indexer_init(struct gzip_indexer *out, uint64_t total);
void gzip_indexer_finish(struct gzip_indexer *indexer);

/** @p size bytes were unpacked. */
void gzip_indexer_add(struct gzip_indexer *indexer, const uint8_t *data, size_t size);

/** inflate() returned from Z_BLOCK, with @p unpacked and @p packed bytes of the stream behind it: a point, if a block
 * begins here, and the last point is far enough. */
void gzip_indexer_stop(struct gzip_indexer *indexer, struct z_stream_s *z, uint64_t unpacked, uint64_t packed);

/** A member ended, with @p packed bytes of the stream behind it. */
void gzip_indexer_end_member(struct gzip_indexer *indexer, uint64_t packed);

/** Appends the index, of whose parts @p whole has unpacked, packed, junk and sha256. False where there is none, or none
 * that helps. */
bool gzip_indexer_write(struct buffer *out, struct gzip_indexer *indexer, const struct gzip_index *whole);

#endif
