/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Sends a selection to the programs that are connected: 3D Slicer shows it. */
#ifndef CONUS_LINK_SEND_SELECTION_H
#define CONUS_LINK_SEND_SELECTION_H

#include "conus/selection.h"
#include "link/station.h"

/** Sends @p selection of @p selector: the rows of its report as NDJSON, and the contacts of its best results. */
void station_send_selection(struct station *station, const conus_selector *selector, const conus_atlas *atlas,
                            const conus_selection *selection);

#endif
