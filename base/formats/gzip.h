/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Unpacking gzip without trusting it: nothing is allocated beyond what the caller says it needs, every checksum is
 * verified, and a stream that holds much more than it should is refused instead of unpacked. */
#ifndef CONUS_BASE_FORMATS_GZIP_H
#define CONUS_BASE_FORMATS_GZIP_H

#include "base/files/file.h"
#include "base/gzip_mark.h"

/** Unpacks the first @p limit bytes, or fewer where the stream ends earlier. No checksum is looked at. */
conus_status gzip_head(struct bytes *out, const uint8_t *data, size_t size, size_t limit);

/** Unpacks the whole of @p data, whose size is not known, verifying every checksum. More than @p limit bytes are
 * CONUS_ERROR_MEMORY; anything but zeros after the last member is CONUS_ERROR_DATA. */
conus_status gzip_unpack_all(struct bytes *out, const uint8_t *data, size_t size, uint64_t limit);

/** The same of one stream of zlib (RFC 1950), which ends with @p data. */
conus_status gzip_unpack_zlib(struct bytes *out, const uint8_t *data, size_t size, uint64_t limit);

/** Reads the whole file @p path, packed or not, and unpacks it: at most @p limit bytes, which are the caller's to raise
 * by --max-memory. Errors carry the path. */
conus_status gzip_read(struct bytes *out, const char *path, uint64_t limit);

/** Gets unpacked bytes, GZIP_SLAB of them or, in the end, fewer. What fails ends the unpacking. */
typedef conus_status gzip_sink(void *user, const uint8_t *data, size_t size);

enum { GZIP_SLAB = 1 << 18 };

/** The unpacked bytes to keep, and what was found after them. */
struct gzip_range {
    uint64_t from;   /**< First byte to keep. */
    size_t count;    /**< Bytes to keep. */
    uint64_t total;  /**< Bytes that the stream must hold at least; from + count or more. */
    bool zlib;       /**< It is one stream of zlib (RFC 1950), not gzip. */
    gzip_sink *sink; /**< Where they go, slab by slab; NULL = they are kept. */
    void *user;      /**< Passed to the sink. */
    uint64_t extra;  /**< Out: bytes after `total`.                                                  */
    size_t junk;     /**< Out: bytes after the last gzip member, other than zeros at the very end.   */
};

enum { GZIP_EXTRA_LIMIT = 1 << 20 }; /**< More bytes than this after `total` are refused. */

/** Unpacks the whole of @p data (one member or several) and keeps the bytes of @p range. With a sink @p out becomes
 * empty; what the sink has got is not verified before this has succeeded. */
conus_status gzip_unpack(struct bytes *out, struct gzip_range *range, const uint8_t *data, size_t size);

#endif
