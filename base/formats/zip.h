/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The files of a zip archive (PKWARE's APPNOTE.TXT; ZIP64 too), which are stored or packed by deflate. Nothing is
 * trusted. The central directory and the header before each file must agree, files must not overlap, no name may occur
 * twice or lead out of a folder, and a size that the packed bytes cannot have or a wrong checksum is an error.
 * Encrypted archives, parts of an archive, and bytes after its end are refused. */
#ifndef CONUS_BASE_FORMATS_ZIP_H
#define CONUS_BASE_FORMATS_ZIP_H

#include "base/job/job.h"

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
