/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Poses as other programs write them: one parser per format, from bytes to rows (docs/formats.md). A parser fails only
 * where the file as a whole cannot be read; a bad pose is a row with its error. */
#ifndef CONUS_POSES_POSE_FILE_H
#define CONUS_POSES_POSE_FILE_H

#include "poses/pose_list.h"

/** Adds the rows of @p text, with notes and the space that it names. @p list is the caller's to finish, always. */
typedef conus_status (*pose_parser)(conus_pose_list *list, struct text text, const conus_pose_options *options);

/** Brainsight's export: sections of targets, samples and electrodes; landmarks are passed over. */
conus_status pose_brainsight_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);
/** Whether a line that begins with # is one of Brainsight's, not a comment. */
bool pose_brainsight_line(struct text line);

/** Localite's markers, InstrumentMarker*.xml and TriggerMarkers*.xml. */
conus_status pose_localite_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);

/** 3D Slicer's markups, .mrk.json: lines and points. */
conus_status pose_markups_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);

/** Electrodes of BIDS, *_electrodes.tsv, in units of list->space: points, or poses along their shafts. */
conus_status pose_electrodes_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);
/** Whether @p line is the header of such a table. */
bool pose_electrodes_header(struct text line);

/** What a *_coordsystem.json says of electrodes: CONUS_ERROR_DATA for a space that is no image's world, and for units
 * that are no lengths. */
conus_status pose_coordsystem_parse(struct pose_space *out, struct text text);
/** Lets list->space be what the *_coordsystem.json beside the table @p path says, and list->coordsystem its path; or
 * else what the table's name says, with a note. */
conus_status pose_coordsystem_find(conus_pose_list *list, const char *path);

#endif
