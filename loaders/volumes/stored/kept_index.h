/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Indexes of packed volumes in the user's cache folder, one file NAME.index each, under the rules of atlases: an entry
 * is believed only if it is the user's alone, this build wrote it, its checksums hold, and the packed file is as it
 * was, by device, inode, size and times of change. What it leads to is verified span by span beyond that. */
#ifndef CONUS_LOADERS_VOLUMES_STORED_KEPT_INDEX_H
#define CONUS_LOADERS_VOLUMES_STORED_KEPT_INDEX_H

#include "base/cache/cache_store.h"
#include "base/files/file_trace.h"
#include "base/formats/gzip_index.h"

#define KEPT_INDEX_ENDING ".index"

/** The most that the indexes may have together, in bytes, unless $CONUS_CACHE is less. */
#define KEPT_INDEX_LIMIT (UINT64_C(1) << 30)

/** An index that is there, and the file that it is of. */
struct kept_index {
    struct cache_mapping mapping; /**< memory NULL = there is none */
    struct gzip_index index;
    int descriptor;           /**< Of the packed file.  */
    struct file_state before; /**< ... when it was opened. */
};

/** Opens the packed file @p path with the index that was kept of it, as the voxels of @p header: the bytes of the file
 * that says how they are packed, NULL = none but @p path. False where there is none that may be believed. */
bool kept_index_open(struct kept_index *out, const char *path, const struct bytes *header);

/** Whether the file is still as it was. */
bool kept_index_holds(const struct kept_index *kept);
void kept_index_finish(struct kept_index *kept);

/** Makes an index, and keeps it. */
struct index_keeper {
    struct gzip_indexer indexer;
    struct cache_store store; /**< Without a path nothing is kept. */
    struct file_trace trace;  /**< Of the packed file, since before it was read; empty if nothing is to be kept. */
};

/** Before @p path is read, as for kept_index_open(). The indexer is the caller's to begin, once it is known how much
 * there is to unpack. */
void index_keeper_begin(struct index_keeper *out, const char *path, const struct bytes *header);
void index_keeper_finish(struct index_keeper *keeper);

/** Once all of the file is unpacked, where index_keeper.indexer was told, and verified: keeps the index, of whose parts
 * @p whole has unpacked, junk and sha256. False where it is not kept, as of a file that changed just now. */
bool index_keeper_keep(struct index_keeper *keeper, struct gzip_index *whole);

#endif
