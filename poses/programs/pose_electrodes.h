/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tables of electrodes, as BIDS has them. */
#ifndef CONUS_POSES_PROGRAMS_POSE_ELECTRODES_H
#define CONUS_POSES_PROGRAMS_POSE_ELECTRODES_H

#include "poses/rows/pose_list.h"

/** Electrodes of BIDS, *_electrodes.tsv, in units of list->space: points, or poses along their shafts. */
conus_status pose_electrodes_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);
/** Whether @p line is the header of such a table. */
bool pose_electrodes_header(struct text line);

#endif
