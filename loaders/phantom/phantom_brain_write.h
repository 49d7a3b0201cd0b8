/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The brain phantom as files. phantom_write.c writes the others, which are drawings. */
#ifndef CONUS_LOADERS_PHANTOM_PHANTOM_BRAIN_WRITE_H
#define CONUS_LOADERS_PHANTOM_PHANTOM_BRAIN_WRITE_H

#include "base/status.h"

/** Writes the brain phantom (atlas/phantom/phantom_brain.h) into @p folder, which must be there: the surfaces
 * brain-NN-ABBREVIATION.surf.gii, brain-context.nii.gz, brain-pathway.nii.gz and, last, brain.atlas.json. */
conus_status phantom_brain_write(const char *folder);

#endif
