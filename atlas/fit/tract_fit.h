/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Compares the place of streamlines with that of the areas. */
#ifndef CONUS_ATLAS_FIT_TRACT_FIT_H
#define CONUS_ATLAS_FIT_TRACT_FIT_H

#include "atlas/atlas.h"

/** Adds a warning to @p notes about the bundle @p name, streamlines that are to be added to @p atlas: if their size
 * suggests other units (fit_note_size()); else if all their coordinates look like voxel indices and the file does not
 * state mm; else if a twentieth of their points more was in the box around the areas before the atlas was moved; else
 * if less than half of them are in that box. Nothing without areas or points. CONUS_ERROR_MEMORY. */
conus_status tract_fit_note(struct notes *notes, const conus_atlas *atlas, const struct tractogram *tractogram,
                            const char *name);

#endif
