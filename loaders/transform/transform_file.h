/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file that moves points from one space to another, by whatever program. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_FILE_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_FILE_H

#include "conus/atlas.h"
#include "loaders/transform/transform_chain.h"
#include "sources/source.h"

/** Reads the transform in @p source, for points of where poses are: an affine, a field, a B-spline or a chain. Of
 * @p options, from and to are the images that an FSL matrix, a register.dat or FSL's field is between, and transform is
 * which of several. What was read, but these images, goes into the job's files; what a careful user should know into
 * its notes, with the path. Errors name path, field, value and what is allowed; CONUS_ERROR_UNSUPPORTED for kinds of
 * transforms that are not read. End @p out with transform_chain_finish(), also after a failure. */
void transform_read(struct job *job, struct transform_chain *out, struct source *source,
                    const conus_transform_options *options);

#endif
