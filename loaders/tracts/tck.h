/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * MRtrix tractograms (.tck): lines "key: value" up to END, then points of three floats or doubles in world mm, of which
 * three times NaN ends a streamline and three times infinity the file. */
#ifndef CONUS_LOADERS_TRACTS_TCK_H
#define CONUS_LOADERS_TRACTS_TCK_H

#include "loaders/tracts/tract_file.h"

bool tck_is(const struct bytes *head, const char *path);

tract_reader tck_read;

#endif
