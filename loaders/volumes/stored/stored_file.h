/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of which some bytes are wanted, packed or not.
 *
 * Packed volumes have indexes in the user's cache folder, one file NAME.index each, under the rules of atlases: an
 * entry is believed only if it is the user's alone, this build wrote it, its checksums hold, and the packed file is as
 * it was, by device, inode, size and times of change. What it leads to is verified span by span beyond that. */
#ifndef CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H
#define CONUS_LOADERS_VOLUMES_STORED_STORED_FILE_H

#include "base/cache/cache_store.h"
#include "base/files/file_trace.h"
#include "base/formats/gzip_index.h"

#define KEPT_INDEX_ENDING ".index"

/** The most that the indexes may have together, in bytes, unless $CONUS_CACHE is less. */
#define KEPT_INDEX_LIMIT (UINT64_C(1) << 30)

enum { STORED_LARGE = 1 << 24 }; /**< Bytes; a larger file or volume is not held in memory twice. */

/** An index, and the file that it belongs to. */
struct kept_index {
    struct cache_mapping mapping; /**< memory NULL = there is none */
    struct gzip_index index;
    int descriptor;           /**< The open packed file. */
    struct file_state before; /**< Its state when it was opened. */
};

/** Opens the packed file @p path with the index that was kept of it. @p header has the bytes of the file that says how
 * the voxels are packed; NULL = @p path itself. False where no index may be believed. */
bool kept_index_open(struct kept_index *out, const char *path, const struct bytes *header);
void kept_index_finish(struct kept_index *kept);

/** Makes an index, and keeps it. */
struct index_keeper {
    struct gzip_indexer indexer;
    struct cache_store store; /**< Without a path nothing is kept. */
    struct file_trace trace;  /**< The packed file as it was before it was read; empty if nothing is to be kept. */
};

/** Before @p path is read, as for kept_index_open(). The indexer is the caller's to begin, once it is known how much
 * there is to unpack. */
void index_keeper_begin(struct index_keeper *out, const char *path, const struct bytes *header);
void index_keeper_finish(struct index_keeper *keeper);

struct stored {
    char *path;
    struct bytes bytes;          /**< As they are stored; none where there is an index or a plain file. */
    bool packed;                 /**< The whole file is gzip. */
    struct kept_index *index;    /**< Owned; NULL = none. */
    struct plain_file *plain;    /**< Owned: not packed, read slab by slab when it is wanted; NULL = it is in memory. */
    struct index_keeper *keeper; /**< Owned: makes an index; NULL = none. */
};

/** Whether an index of a packed file is used and made. */
enum stored_use {
    STORED_PLAIN, /**< Nothing.                                         */
    STORED_KEEP,  /**< One is to be made.                               */
    STORED_INDEX  /**< Use an index, and make one where there is none. */
};

/** Opens @p path, a file of at most @p limit bytes: reads it as a whole, unless its index is used. @p header: the bytes
 * of another file that says how it is packed, from which its index follows, too; NULL = none. Errors carry the path. */
conus_status stored_open(struct stored *out, const char *path, uint64_t limit, enum stored_use use,
                         const struct bytes *header);

/** Whether the bytes with which a file begins, 540 or all, are those of a kind that can be read slab by slab. */
typedef bool plain_file_test(const uint8_t *data, size_t size);

/** The same without a header, but a file of more than STORED_LARGE bytes that is not packed and passes the test is not
 * read yet, however large it is. @p file, unless NULL, is @p path, open. */
conus_status stored_open_slabs(struct stored *out, const char *path, const struct open_file *file, uint64_t limit,
                               enum stored_use use, plain_file_test *test);
void stored_finish(struct stored *stored);

/** The first @p limit bytes, or fewer: unpacked where the whole file is packed. No bytes if there is an index of only a
 * part of the file. */
conus_status stored_head(struct bytes *out, const struct stored *stored, size_t limit);

/** The SHA-256 of the file as an index has it, or as it came out when the range of a plain file was read, "" before.
 * False where it is that of `bytes`. */
bool stored_known_sum(char out[65], const struct stored *stored);

/** Unpacks a range, as gzip_unpack() and gzip_keep() do. With @p sha256, the file's in hexadecimal, it also makes and
 * keeps the index where one is to be made; NULL = it is not worth it. */
conus_status stored_range(struct bytes *out, struct gzip_range *range, struct stored *stored, const char *sha256);

/** The same, from a gzip or zlib (range->zlib) stream inside a file: @p size bytes from @p begin. An index, where there
 * is one, has its own place of the stream. */
conus_status stored_stream(struct bytes *out, struct gzip_range *range, struct stored *stored, size_t begin,
                           size_t size, const char *sha256);

#endif
