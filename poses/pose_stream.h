/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses block by block, from any format. */
#ifndef CONUS_POSES_POSE_STREAM_H
#define CONUS_POSES_POSE_STREAM_H

#include "base/notes.h"
#include "base/text.h"
#include "conus/pose_file.h"

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

/** The name of the file @p path in messages: itself, or "standard input". */
const char *pose_path_name(const char *path);

#endif
