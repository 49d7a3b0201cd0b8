/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The Allen CCF's place in an atlas (include/conus/space.h has the spaces). */
#ifndef CONUS_ATLAS_FRAME_H
#define CONUS_ATLAS_FRAME_H

#include "atlas/atlas.h"
#include "conus/space.h"

/** The size of the CCF's grid along AP, DV and ML, micrometres: 528 x 320 x 456 voxels of 25. */
extern const double frame_ccf_size[3];

/** Whether a grid of these sizes, micrometres along AP, DV and ML, is the CCF's. */
bool frame_is_ccf_size(const double size[3]);

/** Declares an atlas that was not moved to be the Allen CCF, whose corner, where AP, DV and ML start, is the world's
 * origin: AP grows backward, DV downward; ML grows to the left if @p from_right, as in BrainGlobe, else to the right,
 * as at the Allen Institute. CONUS_ERROR_DATA if the first volume's grid is the CCF's at another place. */
conus_status frame_set_ccf(conus_atlas *atlas, bool from_right);

/** The frame of options that have one, or else a space that needs no atlas. CONUS_ERROR_ARGUMENT where its space is
 * none, or needs one. */
conus_status frame_of_options(conus_frame *out, const conus_frame *given, conus_space space);

#endif
