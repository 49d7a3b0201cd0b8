/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * DSI Studio's tractograms (.tt.gz): a MAT-file of level 4 with the variables dimension, trans_to_mni, track and
 * others. Of each streamline track has the number of its coordinates, its first point in 1/32 of a voxel, and the steps
 * to the next ones as bytes. trans_to_mni brings voxels, counted from the centre of the first one, into the world. */
#ifndef CONUS_LOADERS_TRACTS_TT_H
#define CONUS_LOADERS_TRACTS_TT_H

#include "loaders/tracts/tract_file.h"

bool tt_is(const struct bytes *head, const char *path);

tract_reader tt_read;

#endif
