/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A tracker, from inside. */
#ifndef CONUS_SELECTION_STUDY_TRACKER_H
#define CONUS_SELECTION_STUDY_TRACKER_H

#include "conus/conus.h"

/** The tracker's options with defaults filled in. */
const conus_tracker_options *tracker_options(const conus_tracker *tracker);

#endif
