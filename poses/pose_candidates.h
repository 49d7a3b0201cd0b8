/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses from entries and targets, each made when it is asked for (Eq. 22). */
#ifndef CONUS_POSES_POSE_CANDIDATES_H
#define CONUS_POSES_POSE_CANDIDATES_H

#include "base/status.h"
#include "conus/candidates.h"

enum { POSE_CANDIDATE_ID = 96 }; /**< "e1-t1-k1-r1", each number of at most 20 digits. */

struct pose_candidates {
    conus_candidates asked;
    conus_frame frame;
    uint64_t *rings;   /**< [ring_count + 1] Number of the first tilt of each ring, the untilted direction the first; */
    size_t ring_count; /**< behind the last one how many tilts there are. */
    uint64_t rolls;    /**< Turns about the axis, 1 = none. */
    uint64_t count;    /**< 0 = there are none at all: the stream is of a file. */
};

/** Fills a zeroed one, checked; pose_candidates_finish() ends it, also after a failure. */
conus_status pose_candidates_init(struct pose_candidates *out, const conus_candidates *asked);
void pose_candidates_finish(struct pose_candidates *candidates);

/** Candidate @p index, from 0. A row with an error when there is no direction: CONUS_ERROR_ARGUMENT. */
conus_status pose_candidates_row(conus_pose_row *out, char id[POSE_CANDIDATE_ID],
                                 const struct pose_candidates *candidates, uint64_t index);

#endif
