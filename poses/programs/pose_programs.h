/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses in the files of other programs: the parsers of pose_stream.c's table, and how each file is recognised.
 * A parser adds the rows of the text to the list, with the space that it names, and notes to the job. */
#ifndef CONUS_POSES_PROGRAMS_POSE_PROGRAMS_H
#define CONUS_POSES_PROGRAMS_POSE_PROGRAMS_H

#include "base/child/hdf5.h"
#include "base/formats/json_text.h"
#include "base/formats/matlab.h"
#include "base/memory.h"
#include "base/text.h"
#include "conus/pose.h"
#include "poses/rows/pose_row.h"

/** The parsers of the formats that are read whole: void pose_NAME_parse(struct pose_reading *to, struct text text). */
#define READ_BY_LINES(id, word)
#define READ_WHOLE(id, word, parse) void parse(struct pose_reading *to, struct text text);
POSE_FORMAT_ROWS(READ_BY_LINES, READ_WHOLE)
#undef READ_BY_LINES
#undef READ_WHOLE

/** Whether @p line is the header of a table of electrodes of BIDS, @p with_two of one with columns of MNI beside x y z.
 */
bool pose_electrodes_header(struct text line, bool with_two);
/** Whether @p line is the header of the *_markers.tsv of NIBS-BIDS. */
bool pose_nibs_header(struct text line);

/** The space that a *_coordsystem.json of BIDS names: that of the first of the @p modalities that it has, "iEEG/EEG",
 * or else of its only one. It fails for a space that is no image's world, and for units that are no lengths. */
struct pose_space pose_coordsystem_parse(struct job *job, struct text text, const char *modalities);
/** Sets list->space from the *_coordsystem.json beside the table @p path, and list->coordsystem to its path; without
 * that file, if it @p is_needed, from the table's name, with a note, or as pose_coordsystem_hear(). */
void pose_coordsystem_find(struct job *job, conus_pose_list *list, const char *path, bool is_needed, bool has_unit);

/** Sets list->space from such a file beside a table that is not called as those of BIDS, with a note, and says whether
 * there is one. It converts nothing: without a unit of the table (@p has_unit) another one than mm is refused. */
bool pose_coordsystem_hear(struct job *job, conus_pose_list *list, const char *path, bool has_unit);
/** Compares list->space with what the name of the file at @p path says behind "space-": a warning where it is another
 * one. Of a file that says nothing itself it is that, by which no position is moved. @p path NULL: none. */
void pose_coordsystem_hear_name(struct job *job, conus_pose_list *list, const char *path);

/** Whether @p root is such JSON: it has the key xyz_picks, or channel_N of any number. */
bool pose_ibl_is(json_t *root);
/** Which program's JSON @p text is, by its keys; a failure where it is none of poses. */
enum pose_format pose_json_find(struct pose_reading *to, struct text text);

/** Whether this MAT-file is such a reconstruction. */
bool pose_lead_dbs_is(struct pose_reading *to, struct text text);

/** Whether a text with this @p head is such a list, by its words or by how the name @p path ends; NULL: it has none. */
bool pose_lists_know(struct text head, const char *path);

/** Numbers in brackets (Python, MATLAB, JSON), points or matrices; JSON of names or objects that are points; lines of
 * "name: (x, y, z)". */
void pose_brackets_parse(struct pose_reading *to, struct text text);
/** Whether @p text begins as numbers in brackets, "NAME =" in front or not, or its first line is "name: (x, y, z)",
 * "(x, y, z) name" or "(x, y, z) -> (x, y, z)". */
bool pose_brackets_are_rows(struct text text);
/** Whether @p head is of a table that has the three coordinates in one cell. */
bool pose_brackets_in_cells(struct text head);
/** Behind lines of comments and empty ones. */
struct text pose_brackets_behind_comments(struct text text);
/** What an object of JSON is: a point set of Freeview's, or names whose values all are three numbers. */
enum pose_brackets { BRACKETS_NONE, BRACKETS_FREEVIEW, BRACKETS_NAMES };
enum pose_brackets pose_brackets_json(json_t *root);

/** The same of the columns of electrodes in @p hdf5. */
void pose_nwb_from_hdf5(const struct pose_reading *to, const struct hdf5 *hdf5);

/** The points of an .fcsv, named by their labels; of Slicer 3 (label,x,y,z,sel,vis) and since 4 (id,x,y,z, …, label,
 * …). */
void pose_fcsv_parse(struct pose_reading *to, struct text text);

/** What the MAT-file @p text has, which is no longer than pose_memory(), or JSON; nothing after a failure. Each text is
 * parsed once. */
const struct matlab *pose_matlab(struct pose_reading *to, struct text text);
json_t *pose_json(struct pose_reading *to, struct text text);

/** Whether @p text is of a recording: SpikeGLX's .ap.meta or .imro, or XML. */
bool probe_recording_is(struct text text);

/** Writes such a text's contacts and tips as JSON of ProbeInterface: a probe of SpikeGLX, the probes of Open Ephys's
 * settings.xml. @p tip: mm from the tip to the lowest row that the probe has, recorded or not; 0 = that of its part
 * number. CONUS_ERROR_DATA for what does not say where its contacts are. */
conus_status probe_recording_write(struct buffer *out, struct text text, double tip);

/** As conus_probe_load(), from @p text. Errors name no file. */
conus_status probe_parse(conus_probe **out, struct text text, const conus_probe_options *options);

#endif
