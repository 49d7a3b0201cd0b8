/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * NIfTI-1 and NIfTI-2 headers (nifti1.h, nifti2.h of the NIfTI Data Format Working Group). Strict: what the standard
 * does not allow is an error that names the field, because a silently repaired header moves or drops areas. */
#ifndef CONUS_LOADERS_VOLUMES_NIFTI_H
#define CONUS_LOADERS_VOLUMES_NIFTI_H

#include "base/files/file.h"
#include "base/notes.h"
#include "loaders/file_kind.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_header.h"

/** Bytes that nifti_header_parse() wants to see, if there are as many: the header, and where the XML of CIFTI begins.
 */
enum { NIFTI_HEAD_SIZE = 1024 };

/** True where @p data begins with the size of a NIfTI (or ANALYZE) header in either byte order. */
bool nifti_is(const uint8_t *data, size_t size);

/** True where @p data is a NIfTI header with its magic bytes. */
bool nifti_has_magic(const uint8_t *data, size_t size);

enum { NIFTI_DENSE_LABELS = 3007 }; /**< Intent code of a .dlabel.nii. */

/** Intent code of the CIFTI-2 file, a NIfTI-2 file without a grid, that begins with @p data; 0 if it is none. */
int nifti_matrix_intent(const uint8_t *data, size_t size);

/** What the CIFTI-2 file that begins with @p data is, and what conus can do with it; NULL if it is none. */
const struct file_kind *nifti_matrix_kind(const uint8_t *data, size_t size);

/** Reads the fixed part of the header of a CIFTI-2 file, which has no grid and no place: @p shape becomes dim[5] and
 * dim[6], the faster index first, info.volume_count their product. */
conus_status nifti_matrix_parse(struct volume_header *out, size_t shape[2], const uint8_t *data, size_t size);

/** Reads the fixed part of a header. */
conus_status nifti_header_parse(struct volume_header *out, const uint8_t *data, size_t size, struct notes *notes);

/** Lists the extensions in @p head, which holds everything before the voxels; *end is where the last one ends. Broken
 * ones are an error: labels would vanish with them. @p out is the caller's to memory_free(). */
conus_status nifti_extensions_parse(struct volume_extension **out, size_t *count, size_t *end, const struct bytes *head,
                                    const struct volume_header *header);

#endif
