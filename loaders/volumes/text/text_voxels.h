/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The voxels that a header of text describes, out of the bytes of their file. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_TEXT_VOXELS_H
#define CONUS_LOADERS_VOLUMES_TEXT_TEXT_VOXELS_H

#include "loaders/volumes/stored/stored_file.h"
#include "loaders/volumes/text/text_volume.h"

/** What is wanted, and what was found. */
struct text_range {
    size_t volume_size;       /**< Bytes of a volume in memory.              */
    size_t volume;            /**< The one that is wanted, unless            */
    bool all;                 /**< all are, one behind the other.            */
    const char *sha256;       /**< As for stored_range(). */
    struct gzip_range stored; /**< In: the sink, only of packed voxels that are not interleaved. Out: extra, junk. */
};

/** Unpacks and decodes voxels out of the file @p stored, whose bytes may be gone afterwards. Numbers written as text
 * come in this machine's byte order, all others as they are stored. Interleaved volumes are taken apart. Nothing is
 * allocated that the file cannot fill. */
conus_status text_voxels_read(struct bytes *out, struct text_range *range, const struct text_volume *volume,
                              struct stored *stored);

#endif
