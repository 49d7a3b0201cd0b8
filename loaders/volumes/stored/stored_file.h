/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of which some bytes are wanted, packed or not. */
#ifndef CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H
#define CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H

#include "loaders/volumes/stored/kept_index.h"

struct stored {
    char *path;
    struct bytes bytes;          /**< As they are stored; none where there is an index. */
    bool packed;                 /**< By gzip. */
    struct kept_index *index;    /**< Owned; NULL = none. */
    struct index_keeper *keeper; /**< Owned: of an index to be made; NULL = none. */
};

/** What to do about an index of a packed file. */
enum stored_use {
    STORED_PLAIN, /**< Nothing.                                         */
    STORED_KEEP,  /**< One is to be made.                               */
    STORED_INDEX  /**< One is to be used, and where there is none, made. */
};

/** Opens @p path, a file of at most @p limit bytes: reads it as a whole, unless its index is used. Errors carry the
 * path. */
conus_status stored_open(struct stored *out, const char *path, uint64_t limit, enum stored_use use);
void stored_finish(struct stored *stored);

/** The first @p limit unpacked bytes, or fewer. */
conus_status stored_head(struct bytes *out, const struct stored *stored, size_t limit);

/** Moves a range out of what is stored, unpacked, as gzip_unpack() and gzip_keep() do. With the file's @p sha256, in
 * hexadecimal, the index that is to be made is made and kept; NULL = it would not be worth it. */
conus_status stored_range(struct bytes *out, struct gzip_range *range, struct stored *stored, const char *sha256);

#endif
