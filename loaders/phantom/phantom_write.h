/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the writers of phantoms share. */
#ifndef CONUS_LOADERS_PHANTOM_PHANTOM_WRITE_H
#define CONUS_LOADERS_PHANTOM_PHANTOM_WRITE_H

#include "base/buffer.h"

/** Writes @p content as @p name in @p folder; fails with the content's status if that has failed. */
conus_status phantom_write_file(const char *folder, const char *name, const struct buffer *content);

/** Writes the brain phantom (atlas/phantom/phantom_brain.h) into @p folder, which must be there: the surfaces
 * brain-NN-ABBREVIATION.surf.gii, brain-context.nii.gz, brain-pathway.nii.gz and, last, brain.atlas.json. */
conus_status phantom_brain_write(const char *folder);

#endif
