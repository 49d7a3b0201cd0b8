/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * TrackVis tractograms (.trk), version 1 and 2: a header of 1000 bytes, then each streamline as the number of its
 * points, the points with their scalars, and its properties. Points are in mm from the outer corner of the first voxel,
 * along the axes that voxel_order names; docs/spaces.md says how they come into the world. */
#ifndef CONUS_LOADERS_TRACTS_TRK_H
#define CONUS_LOADERS_TRACTS_TRK_H

#include "loaders/tracts/tract_file.h"

bool trk_is(const struct bytes *head, const char *path);

tract_reader trk_read;

#endif
