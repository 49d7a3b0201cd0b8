/* SPDX-License-Identifier: BSD-3-Clause */
/** @file MINC 2: volumes of the Montreal Neurological Institute, which are HDF5 (base/child/hdf5.h). MINC 1 is netCDF.
 */
#ifndef CONUS_LOADERS_VOLUMES_MINC_H
#define CONUS_LOADERS_VOLUMES_MINC_H

#include "base/child/hdf5.h"
#include "base/formats/gzip.h"
#include "loaders/volumes/volume_header.h"

struct minc {
    struct hdf5 *hdf5; /**< NULL = none. */
    const struct hdf5_value *image;
    double *scales;  /**< [slices][2], slope and intercept of stored values; NULL: they are the real ones. */
    size_t slices;   /**< Along the slowest dimensions. */
    double range[2]; /**< Stored values beyond it are no data. */
};

/** Reads the MINC volume @p file, in at most @p limit bytes, and its header. Its voxels are as minc_read() gives them:
 * stored ones, or float64 where each slice has a scale of its own. Messages without a path. CONUS_ERROR_UNSUPPORTED for
 * what is no single volume of regular voxels, and without conus-hdf5. */
conus_status minc_open(struct minc *out, struct volume_header *header, const struct bytes *file, uint64_t limit);

/** Likewise from @p hdf5, which is taken over, on success and on failure. */
conus_status minc_from_hdf5(struct minc *out, struct volume_header *header, struct hdf5 *hdf5);
void minc_finish(struct minc *minc);

/** Gives all voxels to @p sink, i fastest. A value beyond the valid range is NaN. */
conus_status minc_read(const struct minc *minc, gzip_sink *sink, void *user);

#endif
