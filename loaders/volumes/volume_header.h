/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The header of a volume of any format, with NIfTI's datatypes. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_HEADER_H
#define CONUS_LOADERS_VOLUMES_VOLUME_HEADER_H

#include "base/job/job.h"
#include "conus/atlas.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** NIfTI datatype codes. */
enum volume_datatype {
    VOLUME_UINT8 = 2,
    VOLUME_INT16 = 4,
    VOLUME_INT32 = 8,
    VOLUME_FLOAT32 = 16,
    VOLUME_FLOAT64 = 64,
    VOLUME_INT8 = 256,
    VOLUME_UINT16 = 512,
    VOLUME_UINT32 = 768,
    VOLUME_INT64 = 1024,
    VOLUME_UINT64 = 1280
};

struct volume_header {
    conus_volume_info info; /**< format ("NIfTI-1"), datatype, dim, volume_count, slope, intercept and transform.  */
    int datatype;
    bool swapped;
    bool pair;          /**< The voxels lie in another file.                                                  */
    size_t header_size; /**< Bytes of the fixed part: 348, 540, 284.                                          */
    uint64_t offset;    /**< Bytes before the first volume in the file of the voxels. */
    size_t volume_size; /**< Bytes of one volume.                                                             */
    int intent_code;
    bool has_unit;      /**< The file states the unit of its grid. */
    double label_slack; /**< How far from a whole number a label may be. */
};

/** What every grid passes, whatever its format: the Allen Institute's in micrometres is placed where it is meant, one
 * of more than a metre gets a warning, and one row of as many voxels as a cortex has vertices is refused. */
void volume_header_settle(struct job *job, struct volume_header *header);

/** Bytes of a voxel of the NIfTI type @p code, 0 for a type that conus does not read. */
size_t volume_datatype_size(int code);

/** Its name, "uint8"; NULL for a code that no standard knows. */
const char *volume_datatype_name(int code);

/** The code of a type: @p kind 'u' unsigned, 'i' signed, 'f' floating point, of @p size bytes; 0 if there is none. */
int volume_datatype_of(char kind, size_t size);

/** Sets datatype and info.datatype. A type without one real number per voxel is CONUS_ERROR_UNSUPPORTED, a code that no
 * standard knows CONUS_ERROR_DATA. */
void volume_header_set_datatype(struct job *job, struct volume_header *header, int code);

/** Sets info.dim, info.volume_count and volume_size from @p dim[0..6], all at least 1; datatype must be set. Checks
 * that the bytes up to the last voxel can be counted. */
void volume_header_set_dim(struct job *job, struct volume_header *header, const int64_t dim[7]);

#endif
