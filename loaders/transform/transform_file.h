/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that moves points from one space to another, by whatever program. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_FILE_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_FILE_H

#include "base/files/file_sums.h"
#include "base/notes.h"
#include "conus/atlas_info.h"
#include "loaders/transform/transform_chain.h"

/** The transform in @p file, whose name is @p path; arguments and errors otherwise as below, without the path. */
conus_status transform_parse(struct transform_chain *out, const struct bytes *file, const char *path,
                             const conus_transform_options *options);

/** Reads the transform in @p path. Of @p options, from and to are the images that an FSL matrix or a register.dat
 * is between, and transform is which of several. What was read goes into @p read. Errors name path, field, value and
 * what is allowed; CONUS_ERROR_UNSUPPORTED for kinds of transforms that are not read. End @p out with
 * transform_chain_finish(). */
conus_status transform_file_read(struct transform_chain *out, const char *path, const conus_transform_options *options,
                                 struct file_sums *read);

#endif
