/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options of commands that read a file of poses. */
#ifndef CONUS_SETTINGS_POSE_SETTINGS_H
#define CONUS_SETTINGS_POSE_SETTINGS_H

#include "conus/report.h"
#include "settings/atlases.h"

struct pose_file_settings {
    size_t axis;   /* conus_axis */
    size_t format; /* conus_pose_format */
    bool along_shafts;
    bool any_space;
};

enum { KEPT_COLUMNS = 64, KEPT_SIZE = 4096 };

/** Columns of the file whose texts the answer has. */
struct keep_settings {
    const char *columns; /* "group,site"; NULL = none */
};

extern const struct option keep_options[]; /**< keep_settings */

/** Their names. */
struct kept_names {
    const char *at[KEPT_COLUMNS];
    size_t count;
    char text[KEPT_SIZE];
};

/** Splits --keep. Returns the exit code and prints an error unless it is 0. */
int keep_settings_names(struct kept_names *out, const struct keep_settings *settings);

extern const struct option pose_file_options[]; /**< pose_file_settings */

/** A probe whose contacts are asked instead of a cone. */
struct probe_settings {
    const char *path; /* NULL = none */
    double tip, roll; /* mm, degrees */
};

extern const struct option probe_settings_options[]; /**< probe_settings */

/** The options of the library for the file; @p frame must live until the file is opened, @p atlas NULL is not loaded
 * yet, @p max_memory 0 is the default. @p aim NULL: no range ends at a target, and no row is a beam. */
conus_pose_options pose_settings_options(const struct pose_file_settings *settings, const struct aim_settings *aim,
                                         const struct engine_settings *engine, const conus_frame *frame,
                                         const conus_atlas *atlas, uint64_t max_memory);

/** Writes what of the settings the answers depend on: two runs with the same text read the same poses from one file. */
void pose_settings_text(char out[128], const struct pose_file_settings *settings, const struct aim_settings *aim,
                        const struct engine_settings *engine);

/** Name of the file of poses @p path for messages: itself, or "standard input". */
const char *pose_settings_file_name(const char *path);

/** Before the atlas is loaded: refuses an atlas in the place of the file of poses of option @p option. Prints an error
 * unless the exit code is 0. */
int pose_settings_check_file(const char *path, const char *option, const struct arguments *arguments);

/** Prints why no poses were read from the file @p path of option @p option ("pose"): of an atlas or a tractogram that
 * stands there, what to type instead. Gives the exit code that goes with @p status. */
int pose_settings_print_error(conus_status status, const char *path, const char *option,
                              const struct arguments *arguments);

/** Whether @p electrodes, the table that the poses came from (NULL = another format), is there for a @p format that
 * adds columns to it. Returns the exit code and prints an error unless it is 0. */
int pose_settings_check_electrodes(conus_format format, const char *electrodes, const char *path);

/** Loads the probe; *out is NULL where there is none. Returns the exit code and prints an error unless it is 0. */
int probe_settings_load(conus_probe **out, const struct probe_settings *settings, uint64_t max_memory);

/** What marks the rows of answers to a list of poses: their numbers where ids repeat or there are times, which then are
 * marked, too. Returns the exit code and prints an error unless it is 0. */
int pose_settings_mark_list(conus_row_marks *out, const conus_pose_list *poses);

/** The same of a stream, just opened. The table @p path is read once more where it names its rows; where it is no file
 * (@p piped), and where it has more than 2^20 names, these count as repeated. */
int pose_settings_mark_stream(conus_row_marks *out, const conus_pose_stream *poses, const char *path, bool piped,
                              const conus_pose_options *options);

/** Why a row has no cone; NULL if it is a pose. */
const char *pose_settings_row_error(const conus_pose_row *row);

/** Says, unless --quiet, that there is no pose in the file. */
void pose_settings_say_none(const char *path, const struct common_settings *common);

/** Whether the poses' space can be that of each atlas, and says the notes about them, *said of them. Returns the exit
 * code and prints an error unless it is 0. */
int pose_settings_match_stream(size_t *said, conus_pose_stream *poses, const char *path, const struct atlases *atlases,
                               const struct pose_file_settings *settings, const struct common_settings *common);
/** Warns of points that lie far from the areas, or positions of a cap, that they are called as, in any of the atlases.
 */
void pose_settings_warn_of_names(const conus_pose_list *poses, const char *path, const struct atlases *atlases);
/** Says those that came behind the first @p said, when all poses had been read. */
void pose_settings_say_late(conus_pose_stream *poses, const char *path, size_t said,
                            const struct common_settings *common);
/** The same for a list; @p settings may be NULL, of a command without these options. */
int pose_settings_match_list(conus_pose_list *poses, const char *path, const struct atlases *atlases,
                             const struct pose_file_settings *settings, const struct common_settings *common);

#endif
