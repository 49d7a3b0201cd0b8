/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of a deformation field: ITK's (ANTs), SPM's, or FSL's, as NIfTI. */
#ifndef CONUS_LOADERS_TRANSFORM_FIELD_FILE_H
#define CONUS_LOADERS_TRANSFORM_FIELD_FILE_H

#include "atlas/deformation/deformation.h"
#include "base/files/file_sums.h"
#include "base/notes.h"

/** Whether @p path is a NIfTI file, and so no affine. */
conus_status field_file_is(bool *out, const char *path);

/** What the file @p path calls itself, as field_header_words(); NULL also for what is no NIfTI file, or damaged.
 * CONUS_ERROR_IO, CONUS_ERROR_MEMORY. */
conus_status field_file_words(const char **out, bool *usable, const char *path);

/** Reads the field in @p path, for points of where poses are; @p grid describes its nodes. Of @p options, from and to
 * are FSL's images; inverse is refused. What was read goes into @p read, what a careful user should know into
 * @p notes. Errors name path, field, value and what is allowed. End @p out with deformation_finish(). */
conus_status field_file_read(struct deformation *out, conus_volume_info *grid, const char *path,
                             const conus_transform_options *options, struct file_sums *read, struct notes *notes);

#endif
