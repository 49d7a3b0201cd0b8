/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The objects that pictures show of an atlas with pathways or areas of probabilities (Eq. 8): these, and some
 * areas of the parcellation, on one grid. */
#ifndef CONUS_RENDER_COLOUR_PATHWAYS_H
#define CONUS_RENDER_COLOUR_PATHWAYS_H

#include "render/colour/haze.h"

/** How an area is drawn beside pathways. */
enum pathways_area {
    PATHWAYS_AREA_LEFT_OUT = 0,
    PATHWAYS_AREA_OVER, /**< Replaces pathways in the same voxels. */
    PATHWAYS_AREA_UNDER /**< Pathways replace it in the same voxels; it is translucent. */
};

/** The first volume of values that is not hidden, of a pathway or an area; NULL if there is none. */
const struct volume *pathways_first(const conus_atlas *atlas);

/** Whether there is a pathway or bundle that is not hidden: opaque areas would occlude it. */
bool pathways_shown(const conus_atlas *atlas);

/** Makes a volume without values, on the grid of pathways_first(), extended; where there is none, on that of one of the
 * parcellations. It holds all pathways but those in @p hazy, and the areas that @p drawn [object_count + 1] of enum
 * pathways_area names (NULL = none), or all areas where no pathway or bundle is shown. A voxel of several belongs to
 * the first parcellation's area, the most probable area, or the first pathway, in this order.
 * @p out is the caller's to volume_finish() in any case. */
conus_status pathways_join(struct volume *out, const conus_atlas *atlas, const uint8_t *drawn,
                           const struct haze_choice *hazy);

#endif
