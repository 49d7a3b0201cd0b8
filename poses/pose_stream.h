/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses block by block, from any format. */
#ifndef CONUS_POSES_POSE_STREAM_H
#define CONUS_POSES_POSE_STREAM_H

#include "base/notes.h"
#include "base/text.h"
#include "conus/conus.h"

/** As conus_pose_stream_open(), from a text that outlives the stream. Errors name no file. */
conus_status pose_stream_parse(conus_pose_stream **out, struct text text, const conus_pose_options *options);

/** Rows that were read or passed over. */
uint64_t pose_stream_position(const conus_pose_stream *stream);

/** Lets @p list name the stream's space, and have its notes; the stream has none afterwards. */
conus_status pose_stream_take_header(conus_pose_list *list, conus_pose_stream *stream);

/** What messages call the file @p path: itself, or "standard input". */
const char *pose_path_name(const char *path);

#endif
