/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of poses that is replayed, and a head that a tracker sees. */
#ifndef CONUS_VIEWER_MODEL_SOURCE_H
#define CONUS_VIEWER_MODEL_SOURCE_H

#include "link/station.h"
#include "viewer/model/viewer.h"

/** A file of poses on the time line. */
struct replay {
    conus_pose_list *poses; /**< NULL = none; only rows without errors are shown. */
    size_t at;
    bool playing;
    double started; /**< Clock, s, at which the row `from` was shown. */
    size_t from;
};

/** Shows row @p index of the replay. */
void replay_show(struct replay *replay, struct viewer *viewer, size_t index);
/** Seconds from the first row to row @p index: its time_s, or 0.1 s a row where the file has none. */
double replay_time(const struct replay *replay, size_t index);
/** Starts or stops; @p clock in s. */
void replay_toggle(struct replay *replay, double clock);
/** Moves on by the clock. Returns whether it plays. */
bool replay_step(struct replay *replay, struct viewer *viewer, double clock);

/** Seconds until it moves on; INFINITY while it does not play. */
double replay_rest(const struct replay *replay, const struct viewer *viewer, double clock);

/** Asks @p station for its news; the head moves along, if one is named. */
void station_hear(struct station *station, struct viewer *viewer, struct station_news *news);

#endif
