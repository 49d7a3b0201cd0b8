/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * NIfTI-1 and NIfTI-2 headers (nifti1.h, nifti2.h of the NIfTI Data Format Working Group). Strict: what the standard
 * does not allow is an error that names the field, because a silently repaired header moves or drops areas. */
#ifndef CONUS_LOADERS_VOLUMES_NIFTI_H
#define CONUS_LOADERS_VOLUMES_NIFTI_H

#include "loaders/volumes/volume_input.h"
#include "sources/signatures.h"

/** Reads the fixed part of the header of a CIFTI-2 file, which has no grid and no place: @p shape becomes dim[5] and
 * dim[6], the faster index first, info.volume_count their product. */
void nifti_matrix_read(struct job *job, struct volume_header *out, size_t shape[2], const uint8_t *data, size_t size);

/** Lists the *count extensions in @p head, which holds everything before the voxels, and gives where the last one ends.
 * Broken ones are an error: labels would vanish with them. */
size_t nifti_extensions_read(struct job *job, struct volume_extension **out, size_t *count, struct text head,
                             const struct volume_header *header);

#endif
