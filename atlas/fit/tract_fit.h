/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether streamlines lie where the areas of an atlas are. */
#ifndef CONUS_ATLAS_FIT_TRACT_FIT_H
#define CONUS_ATLAS_FIT_TRACT_FIT_H

#include "atlas/atlas.h"

/** Adds a warning to @p notes about the bundle @p name, streamlines that are to be added to @p atlas: where their
 * size is that of other units, by fit_note_size(); else where all their coordinates look like voxel indices and the
 * file does not state mm; else where a twentieth of their points more was in the box around the areas
 * before the atlas was moved; and else where less than half of them are in that box.
 * Nothing where there are no areas or no points. CONUS_ERROR_MEMORY. */
conus_status tract_fit_note(struct notes *notes, const conus_atlas *atlas, const struct tractogram *tractogram,
                            const char *name);

#endif
