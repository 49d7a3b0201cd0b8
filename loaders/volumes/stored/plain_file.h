/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that is not packed, read slab by slab: it is never in memory as a whole. */
#ifndef CONUS_LOADERS_VOLUMES_STORED_PLAIN_FILE_H
#define CONUS_LOADERS_VOLUMES_STORED_PLAIN_FILE_H

#include "base/formats/gzip.h"

struct plain_file {
    int descriptor;
    struct file_state before; /**< When it was opened. */
    char sha256[65];          /**< Once plain_file_range() has read it. */
};

/** Whether the bytes with which a file begins, 540 or all, are those of a kind that can be read so. */
typedef bool plain_file_test(const uint8_t *data, size_t size);

/** Opens @p path if it is a regular file of more than @p least bytes that passes the test. False
 * where it is none, or cannot be opened; who reads it as a whole says why. */
bool plain_file_open(struct plain_file *out, const char *path, uint64_t least, plain_file_test *test);
void plain_file_finish(struct plain_file *plain);

/** The first @p limit bytes, or fewer. CONUS_ERROR_IO, CONUS_ERROR_MEMORY. */
conus_status plain_file_head(struct bytes *out, const struct plain_file *plain, size_t limit);

/** Reads all of the file once, for its sum, and gives the bytes of the range: kept, or to the sink slab by slab.
 * CONUS_ERROR_DATA where the file has fewer bytes than range->total, CONUS_ERROR_IO where it changed meanwhile. */
conus_status plain_file_range(struct bytes *out, struct gzip_range *range, struct plain_file *plain);

#endif
