/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The voxels of a volume as labels or as numbers. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_VALUES_H
#define CONUS_LOADERS_VOLUMES_VOLUME_VALUES_H

#include "loaders/volumes/volume_file.h"

/** Decodes to labels, one per voxel. Refuses scaled values that are not whole, or outside 0..4294967295, naming the
 * first such voxel. *out is the caller's to memory_free(). Sets info.minimum and maximum. */
conus_status volume_file_labels(uint32_t **out, struct volume_file *file);

/** Decodes to scaled values. Values that are not finite become 0, and a note counts them. Otherwise as above. */
conus_status volume_file_values(float **out, struct volume_file *file, struct notes *notes);

/** The same, but that these become NaN, which minimum and maximum disregard. CONUS_ERROR_DATA where all are. */
conus_status volume_file_values_or_nan(float **out, struct volume_file *file, struct notes *notes);

/** The stored number at @p data, of the NIfTI type @p datatype, unscaled; rounded where it has more than 53 bits. */
double volume_value_at(const uint8_t *data, int datatype, bool swapped);

#endif
