/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Packed files: gzip and zip. */
#ifndef CONUS_BASE_FORMATS_PACKED_H
#define CONUS_BASE_FORMATS_PACKED_H

#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/job/job.h"

/* Unpacking gzip without trusting it: nothing is allocated beyond what the caller says it needs, every checksum is
 * verified, and a stream that holds much more than it should is refused instead of unpacked. */

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

/* The files of a zip archive (PKWARE's APPNOTE.TXT; ZIP64 too), which are stored or packed by deflate. Nothing is
 * trusted. The central directory and the header before each file must agree, files must not overlap, no name may
 * occur twice or lead out of a folder, and a size that the packed bytes cannot have or a wrong checksum is an error.
 * Encrypted archives, parts of an archive, and bytes after its end are refused. */

/** A file of the archive. */
struct zip_entry {
    struct text name; /**< "dps/weight.float32", inside the archive's bytes: UTF-8, one line, parted by '/'. */
    size_t at;        /**< Offset of its first byte in the archive, packed or not. */
    size_t stored;    /**< Bytes there.                                                                      */
    uint64_t size;    /**< Bytes, unpacked.                                                                  */
    uint32_t checksum;
    bool is_packed;
};

struct zip {
    const uint8_t *data;       /**< The archive, which outlives this. */
    struct zip_entry *entries; /**< Sorted by name, without folders. The job's. */
    size_t count;
};

/** True where @p data begins like an archive with a file, or like an empty one. */
bool zip_is(const uint8_t *data, size_t size);

/** Lists the archive @p data, which has no file after a failure. CONUS_ERROR_DATA, and CONUS_ERROR_UNSUPPORTED for what
 * other programs may unpack. */
struct zip zip_parse(struct job *job, const uint8_t *data, size_t size);

/** Verifies the checksum of a file that is not packed: its bytes are zip->data + entry->at, up to entry->size. */
void zip_verify(struct job *job, const struct zip *zip, const struct zip_entry *entry);

/** A copy of the bytes of a file, unpacked and verified, in the job's memory; empty after a failure. At most @p limit,
 * more are CONUS_ERROR_MEMORY. */
struct bytes zip_unpack(struct job *job, const struct zip *zip, const struct zip_entry *entry, uint64_t limit);

#endif
