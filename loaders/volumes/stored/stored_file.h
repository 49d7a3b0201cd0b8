/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of which some bytes are wanted, packed or not. */
#ifndef CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H
#define CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H

#include "loaders/volumes/stored/kept_index.h"
#include "loaders/volumes/stored/plain_file.h"

struct stored {
    char *path;
    struct bytes bytes;          /**< As they are stored; none where there is an index or a plain file. */
    bool packed;                 /**< By gzip, as a whole. */
    struct kept_index *index;    /**< Owned; NULL = none. */
    struct plain_file *plain;    /**< Owned: read when it is wanted; NULL = it is in memory. */
    struct index_keeper *keeper; /**< Owned: of an index to be made; NULL = none. */
};

/** What to do about an index of a packed file. */
enum stored_use {
    STORED_PLAIN, /**< Nothing.                                         */
    STORED_KEEP,  /**< One is to be made.                               */
    STORED_INDEX  /**< One is to be used, and where there is none, made. */
};

/** Opens @p path, a file of at most @p limit bytes: reads it as a whole, unless its index is used. @p header: the bytes
 * of another file that says how it is packed, from which its index follows, too; NULL = none. Errors carry the path. */
conus_status stored_open(struct stored *out, const char *path, uint64_t limit, enum stored_use use,
                         const struct bytes *header);

enum { STORED_LARGE = 1 << 24 }; /**< Bytes beyond which a file or a volume is not to be in memory twice. */

/** The same without a header, but a file of more than STORED_LARGE bytes that is not packed and passes the test is not
 * read yet, however large it is. */
conus_status stored_open_slabs(struct stored *out, const char *path, uint64_t limit, enum stored_use use,
                               plain_file_test *test);
void stored_finish(struct stored *stored);

/** The first @p limit bytes, or fewer: unpacked where the file is packed as a whole. Where an index is of a part of it,
 * none of that. */
conus_status stored_head(struct bytes *out, const struct stored *stored, size_t limit);

/** The SHA-256 of the file as an index has it, or as it came out when the range of a plain file was read, "" before.
 * False where it is that of `bytes`. */
bool stored_known_sum(char out[65], const struct stored *stored);

/** Moves a range out of what is stored, unpacked, as gzip_unpack() and gzip_keep() do. With the file's @p sha256, in
 * hexadecimal, the index that is to be made is made and kept; NULL = it would not be worth it. */
conus_status stored_range(struct bytes *out, struct gzip_range *range, struct stored *stored, const char *sha256);

/** The same out of a stream in a file, of gzip or range->zlib: @p size bytes from @p begin on, which are of no meaning
 * where there is an index. */
conus_status stored_stream(struct bytes *out, struct gzip_range *range, struct stored *stored, size_t begin,
                           size_t size, const char *sha256);

#endif
