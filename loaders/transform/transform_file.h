/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that moves points from one space to another, by whatever program. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_FILE_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_FILE_H

#include "base/files/file_sums.h"
#include "base/notes.h"

/** The affine in @p file, whose name is @p path; arguments and errors otherwise as below, without the path. */
conus_status transform_parse(double out[16], const struct bytes *file, const char *path, const char *from,
                             const char *to);

/** Reads the affine in @p path as a matrix from points to points, RAS mm. @p from and @p to are the images that an FSL
 * matrix is between; NULL otherwise. What was read goes into @p read. Errors name path, field, value and what is
 * allowed; CONUS_ERROR_UNSUPPORTED for kinds of transforms that are not read. */
conus_status transform_file_read(double out[16], const char *path, const char *from, const char *to,
                                 struct file_sums *read);

#endif
