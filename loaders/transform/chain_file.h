/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of several transforms: HDF5, of ITK or X5. */
#ifndef CONUS_LOADERS_TRANSFORM_CHAIN_FILE_H
#define CONUS_LOADERS_TRANSFORM_CHAIN_FILE_H

#include "base/files/file_sums.h"
#include "base/notes.h"
#include "loaders/transform/transform_chain.h"

/** Reads the chain in @p path, of points from where poses are. Errors and @p read as of transform_file_read(). What a
 * careful user should know goes into @p notes, with the path. @p max_memory: bytes of all fields; 0 = 8 GiB. */
conus_status chain_file_read(struct transform_chain *out, const char *path, uint64_t max_memory, struct file_sums *read,
                             struct notes *notes);

#endif
