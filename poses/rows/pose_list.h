/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All poses of a file at once. */
#ifndef CONUS_POSES_ROWS_POSE_LIST_H
#define CONUS_POSES_ROWS_POSE_LIST_H

#include "base/notes.h"
#include "base/text.h"
#include "conus/pose_file.h"
#include "poses/rows/pose_row.h"

/** Which brain a space belongs to. */
enum pose_brain {
    POSE_BRAIN_UNKNOWN = 0,
    POSE_BRAIN_SUBJECT, /**< Somebody's own scan. */
    POSE_BRAIN_MNI152,
    POSE_BRAIN_TALAIRACH,
    POSE_BRAIN_TEMPLATE, /**< Another template. */
    POSE_BRAIN_COLIN27,
    POSE_BRAIN_MNI305,
    POSE_BRAIN_OTHER /**< Somebody's own, but not, or not surely, in the world of its scan: tkRAS, n/a. */
};

/** All 0: the file names none. */
struct pose_space {
    char name[64]; /**< As the file has it: "NIfTI:Scanner". */
    enum pose_brain brain;
    double scale;    /**< mm per unit of the file's numbers; 0 = 1. */
    bool is_of_path; /**< The file's name says it, by which nothing is converted. */
};

struct pose_space pose_space_named(struct text name, enum pose_brain brain);

/** CONUS_ERROR_DATA where file and atlas (conus_atlas_brain()) are of different brains; a warning where one of them is
 * unknown, and where some mm lie between two templates; a note between MNI 152 and Colin 27. A subject's own scan fits
 * an atlas that is one person's, or was moved; a warning names another space. */
conus_status pose_space_match(struct notes *notes, const struct pose_space *space, const conus_atlas *atlas);

struct conus_pose_list {
    conus_pose_row *rows; /**< Strings are owned. */
    size_t count;
    size_t capacity;
    bool is_counted;     /**< pose_check_count() holds for it, by `max_memory`. */
    uint64_t max_memory; /**< 0 = the default. */
    struct notes notes;
    struct note_sink sink; /**< Where the notes go. */
    char *name;            /**< Path of the sink; owned, NULL while it is the stream's. */
    struct pose_space space;
    bool is_cap;       /**< Of electrodes, which is checked when it is whole (caps.h). */
    size_t kept_count; /**< Of each row that has some. */
    char *electrodes;  /**< The text of a table of electrodes; owned, NULL of other formats. */
    char *coordsystem; /**< Path of the file that says what the space is; owned, NULL if there is none. */
    char coordsystem_sha256[65];
};

/** Adds a row with copies of its strings. An @p id that is empty becomes the row's number; one that is too long or not
 * UTF-8, too, and then the row has an error. @p error NULL: none. */
conus_status pose_list_add(conus_pose_list *list, const conus_pose_row *row, struct text id, const char *error);

/** Adds a point, in LPS if @p lps, or, where that is not CONUS_OK, what is @p bad about the row. */
conus_status pose_list_add_point(conus_pose_list *list, size_t line, const double point[3], bool lps, struct text id,
                                 conus_status bad);

/** Gives the last row copies of texts that are kept. All rows of a list have as many. */
conus_status pose_list_keep(conus_pose_list *list, const struct kept_text *texts, size_t count);

/** Gives the sink the notes of the list, which keeps a copy of the sink and of its path. */
conus_status pose_list_hear(conus_pose_list *list, const struct note_sink *sink);

/** Takes all rows out, and keeps their memory for the next ones. */
void pose_list_clear(conus_pose_list *list);

/** Frees what is in it. */
void pose_list_finish(conus_pose_list *list);

#endif
