/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A folder of OME-Zarr as a volume: which array of it is meant, and where that lies. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_ZARR_H
#define CONUS_LOADERS_VOLUMES_VOLUME_ZARR_H

#include "base/notes.h"
#include "loaders/volumes/volume_header.h"
#include "loaders/volumes/volume_selector.h"
#include "loaders/zarr/zarr.h"

struct volume_zarr {
    char *folder; /**< Folder of the array; NULL = there is none. */
    struct zarr_array array;
    char orientation[4]; /**< Where OME's metadata say that its axes start, "asr"; empty = they do not. */
    struct bytes labels; /**< The group's metadata, if they have colours and names of labels; else empty. */
};

/** Finds the array of the folder @p path, an image of OME-Zarr or a level of one, that @p selector means, and its
 * header. The files of metadata join @p read. Errors carry the path. */
conus_status volume_zarr_open(struct volume_zarr *out, struct volume_header *header, const char *path,
                              const struct volume_selector *selector, struct file_sums *read);
void volume_zarr_finish(struct volume_zarr *zarr);

/** Reads the voxels of @p volume into @p sink, as zarr_read() does, and their sum into @p sha256, [65]. A note says how
 * many chunks are not there. */
conus_status volume_zarr_read(char sha256[65], const struct volume_zarr *zarr, uint64_t volume, uint64_t limit,
                              zarr_sink *sink, void *user, struct notes *notes);

#endif
