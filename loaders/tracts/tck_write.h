/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Writes MRtrix's tractograms, .tck. */
#ifndef CONUS_LOADERS_TRACTS_TCK_WRITE_H
#define CONUS_LOADERS_TRACTS_TCK_WRITE_H

#include "base/files/file.h"
#include "conus/streamline_list.h"

/** The bytes of a file with the streamlines of @p list, Float32LE. @p out is owned by the caller. */
conus_status tck_format(struct bytes *out, const conus_streamline_list *list);

#endif
