/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Localite's markers. */
#ifndef CONUS_POSES_PROGRAMS_POSE_LOCALITE_H
#define CONUS_POSES_PROGRAMS_POSE_LOCALITE_H

#include "poses/rows/pose_list.h"

/** Localite's markers, InstrumentMarker*.xml and TriggerMarkers*.xml. */
conus_status pose_localite_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);

#endif
