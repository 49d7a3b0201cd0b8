/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a user did to areas, carried over to the same atlas with other hemispheres. Areas are known again by
 * their labels: an area by its own, a half or a pair by that of the area that it was made of. */
#ifndef CONUS_VIEWER_HEMISPHERES_CARRY_H
#define CONUS_VIEWER_HEMISPHERES_CARRY_H

#include "viewer/model/viewer.h"

/** Puts @p atlases, [atlas_count] the viewer's with hemispheres @p how in place of @p before, where its own are, and
 * takes them over. Cone and views stay. Pathways keep their thresholds, areas are hidden and opaque as they were: both
 * halves as the whole, a whole or a pair only where both halves agree, else it is shown and as opaque as the rest.
 * False with a reason in the status line: all is as it was, and they are the caller's. */
bool carry_over(struct viewer *viewer, conus_atlas *const *atlases, conus_hemispheres before, conus_hemispheres how);

#endif
