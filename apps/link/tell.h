/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What was selected, told to those who listen: 3D Slicer shows it. */
#ifndef CONUS_LINK_TELL_H
#define CONUS_LINK_TELL_H

#include "link/station.h"

/** Tells @p selection of @p selector: the rows of its report as NDJSON, and the contacts of its best results. */
void station_tell_selection(struct station *station, const conus_selector *selector, const conus_atlas *atlas,
                            const conus_selection *selection);

#endif
