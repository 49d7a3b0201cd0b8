/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A tool of a tracking station as a source. */
#ifndef CONUS_VIEWER_DEVICES_TRACKER_H
#define CONUS_VIEWER_DEVICES_TRACKER_H

#include "link/station.h"
#include "viewer/devices/source.h"

struct tracker {
    struct source source; /**< First: a pointer to it is one to the tracker. */
    struct station_tool tool;
    uint64_t taken; /**< Number of the pose that was answered last. */
    bool is_there;  /**< There is a station for it. */
};

void tracker_init(struct tracker *out);
/** The station says that its tool is so; NULL = there is no station. */
void tracker_hear(struct tracker *tracker, const struct station_tool *tool);

#endif
