/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses block by block, from any format or from entries and targets (Eq. 22); how their files begin; caps. */
#ifndef CONUS_POSES_POSE_STREAM_H
#define CONUS_POSES_POSE_STREAM_H

#include "base/status.h"
#include "base/text.h"
#include "conus/plan.h"
#include "conus/pose.h"
#include "poses/rows/pose_row.h"

/** As conus_pose_stream_open(), from a text that outlives the stream. Errors name no file. */
conus_status pose_stream_parse(conus_pose_stream **out, struct text text, const conus_pose_options *options);

/** Rows that were read or passed over. */
uint64_t pose_stream_position(const conus_pose_stream *stream);

/** How many texts conus_pose_row.kept of its rows has. */
size_t pose_stream_kept_count(const conus_pose_stream *stream);

/** All poses of @p text (docs/formats.md). A row that is no pose is kept with its error; CONUS_ERROR_DATA is for a text
 * in which no row can be read: an unknown or missing column, nothing at all, not text. @p options NULL = the default.
 */
conus_status pose_list_parse(conus_pose_list **out, struct text text, const conus_pose_options *options);

/** Checks the rows of a cap, brings them to mm by list->space.scale (0 = the cap names no unit), and sets list->space:
 * CONUS_ERROR_DATA, with what fits better, unless the names that are positions (position_find()) lie where MNI 152 has
 * them. @p file: as columns.file. */
conus_status cap_check(conus_pose_list *list, const char *file, struct notes *notes);

enum { POSE_CANDIDATE_ID = 192 }; /**< "e1-t1-k1-r1", each number of at most 20 digits, a name of 64 bytes. */

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
