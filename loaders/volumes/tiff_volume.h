/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A stack of TIFF pages as a volume: i is the column, j the row, k the page. TIFF says neither how large a voxel is nor
 * where it lies: metadata.json beside the file does (docs/spaces.md, "BrainGlobe"), or whoever names the file. */
#ifndef CONUS_LOADERS_VOLUMES_TIFF_VOLUME_H
#define CONUS_LOADERS_VOLUMES_TIFF_VOLUME_H

#include "loaders/brainglobe/brainglobe_metadata.h"
#include "loaders/tiff/tiff.h"
#include "loaders/volumes/volume_header.h"

/** Where the stack @p path lies: @p stated, and what that leaves open as metadata.json beside it says, which then joins
 * @p read. CONUS_ERROR_DATA where voxel size or orientation are missing. */
conus_status tiff_volume_place(struct brainglobe_metadata *out, const char *path,
                               const struct brainglobe_metadata *stated, struct file_sums *read);

/** The header of the stack. A shape in @p place that is not the stack's is CONUS_ERROR_DATA. */
conus_status tiff_volume_header(struct volume_header *out, const struct tiff *tiff,
                                const struct brainglobe_metadata *place);

#endif
