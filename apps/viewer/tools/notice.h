/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the window says of the cone: that it is held, that it is not there yet, that its tool is lost. */
#ifndef CONUS_VIEWER_TOOLS_NOTICE_H
#define CONUS_VIEWER_TOOLS_NOTICE_H

#include "viewer/model/source.h"

struct notice {
    const char *text; /**< One line; NULL = there is nothing to say. */
    bool is_trouble;  /**< The cone is not, or no longer, where its tool is. */
    bool is_old;      /**< So the answer is one from before. */
};

/** @p has_station: there is a tracker, of which @p news are; @p has_poses: there is a file to replay. */
void notice_find(struct notice *out, const struct viewer *viewer, bool has_station, const struct station_news *news,
                 bool has_poses);
/** Of a tool that a tracker moves, which is @p state; @p has_station: there is a tracker for it. @p out is changed only
 * where there is something to say. */
void notice_of_tracker(struct notice *out, bool has_pose, bool has_station, enum station_state state);

#endif
