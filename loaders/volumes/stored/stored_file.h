/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of which some bytes are wanted, packed or not. */
#ifndef CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H
#define CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H

#include "base/formats/gzip.h"

enum { STORED_LARGE = 1 << 24 }; /**< Bytes; a larger file or volume is not held in memory twice. */

struct stored {
    char *path;
    struct bytes bytes;       /**< As they are stored; none where there is a plain file. */
    bool packed;              /**< The whole file is gzip. */
    struct plain_file *plain; /**< Owned: not packed, read slab by slab when it is wanted; NULL = it is in memory. */
};

/** Reads @p path, a file of at most @p limit bytes. Errors carry the path. */
conus_status stored_open(struct stored *out, const char *path, uint64_t limit);

/** Whether the bytes with which a file begins, 540 or all, are those of a kind that can be read slab by slab. */
typedef bool plain_file_test(const uint8_t *data, size_t size);

/** The same, but a file of more than STORED_LARGE bytes that is not packed and passes the test is not read yet, however
 * large it is. @p file, unless NULL, is @p path, open. */
conus_status stored_open_slabs(struct stored *out, const char *path, const struct open_file *file, uint64_t limit,
                               plain_file_test *test);
void stored_finish(struct stored *stored);

/** The first @p limit bytes, or fewer: unpacked where the whole file is packed. */
conus_status stored_head(struct bytes *out, const struct stored *stored, size_t limit);

/** The SHA-256 of a plain file as it came out when its range was read, "" before. False where it is that of `bytes`. */
bool stored_known_sum(char out[65], const struct stored *stored);

/** Unpacks a range, as gzip_unpack() and gzip_keep() do. */
conus_status stored_range(struct bytes *out, struct gzip_range *range, struct stored *stored);

#endif
