/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tables of points and poses: their lines, the roles of columns, and cells by exact names. */
#ifndef CONUS_POSES_ROWS_COLUMNS_H
#define CONUS_POSES_ROWS_COLUMNS_H

#include "base/files/file.h"
#include "base/formats/table.h"
#include "base/job/job.h"
#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/pose.h"
#include "poses/rows/pose_row.h"

#include <nettle/sha2.h>

/* Lines of a text of any length, one at a time, from a file, a pipe or memory, in memory that does not grow. */

enum { POSE_LINE_LIMIT = 65535 }; /**< Longest line that is read, in bytes, without its ending. */

/** Where lines come from. All 0 but `descriptor` = -1 is an empty text. What is stopped ends behind its last whole
 * line. */
struct pose_lines {
    int descriptor;          /**< Borrowed; -1: all there is lies in `data`.                        */
    bool seekable;           /**< A regular file: read at `offset`, without moving the descriptor.  */
    struct system_wake stop; /**< Not seekable: once woken, there is nothing more; borrowed. */
    uint64_t offset;         /**< Where in it the bytes after those in `data` are.                  */
    const char *data;        /**< Bytes not yet taken; in `own`, or borrowed.                       */
    size_t size;
    char *own; /**< NULL where `data` is borrowed. */
    bool ended;
    bool after_cr; /**< A LF that comes now belongs to the line before. */
    size_t number; /**< Lines taken. */

    struct file_state state; /**< Seekable: of the file when it was opened, */
    struct sha256_ctx hash;  /**< and of the bytes that were read. */
};

struct pose_line {
    struct text text; /**< "" when too long. */
    size_t number;    /**< From 1. */
    bool too_long;
    bool blank; /**< Too long, and a comment: no data. */
};

/** Lines of an open file, from @p offset where it is seekable: then CONUS_ERROR_IO once it changes.
 * pose_lines_finish() ends it, without closing. */
conus_status pose_lines_init(struct pose_lines *lines, int descriptor, bool seekable, uint64_t offset);
/** Lines of a text that outlives them. */
void pose_lines_init_text(struct pose_lines *lines, struct text text);
void pose_lines_finish(struct pose_lines *lines);

/** Begins the text, after pose_lines_init(): takes off a byte order mark. UTF-16, which it tells, is read as a whole
 * and becomes UTF-8; CONUS_ERROR_MEMORY above @p limit bytes. */
conus_status pose_lines_begin(struct pose_lines *lines, uint64_t limit);

/** Reads on until @p size bytes (at most POSE_LINE_LIMIT) lie in `data`, or all there are, or, where that is enough,
 * until a pipe is silent for a fifth of a second and something is there. */
conus_status pose_lines_fill(struct pose_lines *lines, size_t size, bool may_be_silent);

/** Takes the next line, ended by LF, CR, CRLF or the end; *found = false when there is none. The line's text lives
 * until the next call. */
conus_status pose_lines_next(struct pose_lines *lines, struct pose_line *line, bool *found);

/** Appends all that is left, CONUS_ERROR_MEMORY above @p limit bytes. @p out is the caller's to finish. */
conus_status pose_lines_rest(struct buffer *out, struct pose_lines *lines, uint64_t limit);

/** SHA-256 of all that was read, and of what is left, which is taken, too. Seekable only. */
conus_status pose_lines_sha256(char out[65], struct pose_lines *lines);

/* Tables of points and poses: which column has which role, the row that a line is, axes in two rows, and what names
 * say of left and right. */

/** What a column may be. Before ROLE_NAME they are numbers. m00 … m33 are row-major. */
enum column_role {
    ROLE_X,
    ROLE_TX = ROLE_X + 3,
    ROLE_AIM = ROLE_TX + 3, /**< What was aimed at; a row can do without. */
    ROLE_DX = ROLE_AIM + 3,
    ROLE_QW = ROLE_DX + 3,
    ROLE_QX,
    ROLE_M00 = ROLE_QX + 3,
    ROLE_UX = ROLE_M00 + 16,
    ROLE_ANGLE = ROLE_UX + 3, /**< From here on a row can do without. */
    ROLE_TIME,
    ROLE_TRIGGER,
    ROLE_ERROR_DEG,
    ROLE_ERROR_MM,
    ROLE_NEAR,
    ROLE_FAR,
    ROLE_DEPTH,
    ROLE_RADIUS,
    ROLE_TILT_ML,
    ROLE_TILT_AP,
    ROLE_PHI,
    ROLE_THETA,
    ROLE_SPACE, /**< May be several columns. */
    ROLE_UNIT,
    ROLE_NAME,
    ROLE_CONTACT, /**< The second half of the name. */
    ROLES         /**< None. */
};

enum { COLUMN_NAME_SIZE = 48 };

/** The words of conus_pose_options.columns. */
struct columns_words {
    struct text at[3], name, place, tilt[2]; /**< Columns; empty: not given. Tilts: ML, AP; alone the other is 0. */
    double unit, length[2];                  /**< mm; 0 = not given. Of positions; of the columns depth and radius. */
    bool any_sides;
};

/** Reads them; CONUS_ERROR_ARGUMENT for a word that is none, or only some of x, y and z. @p text NULL: none. */
conus_status columns_words_parse(struct columns_words *out, const char *text);

/** The first column that is called a tilt, "depth" or "radius" where their unit is given; empty: none of these. */
struct text columns_word_of_axes(const struct columns_words *words);

/** What is known of a table when its head was read. */
struct columns {
    struct table table;
    bool has_header;
    uint8_t role_of[TABLE_CELLS]; /**< Of each cell of a row. */
    size_t count;                 /**< Cells of a row; 0 without a header. */
    bool has[ROLES];
    char shown[ROLES][COLUMN_NAME_SIZE]; /**< What the header calls it. */
    size_t head_lines;                   /**< Lines to the end of the header. */
    uint64_t header_sum;                 /**< Of the header's line. */
    const char *file; /**< Before columns_plan(): as it is typed, with its words, for messages; NULL = "FILE". */
    bool is_bids; /**< Before columns_plan(): marks belong to cells, no column but a direction's is unusual, and only x,
                     y, z and name, or those that the user names, and words of space and unit have a role. */
    int side;     /**< Before columns_plan(): sides_of_file(). */
    double beside_mm;  /**< Before columns_plan(): mm per unit, as a file beside it says; 0 = none does. */
    bool is_of_points; /**< It gives no direction. */
    bool is_straight;  /**< Its rows go straight down, by a depth alone. */
    bool has_space;    /**< It says itself in which space the numbers are: */
    conus_space space;
    double scale;                 /**< Units of the space per unit of positions. */
    size_t kept[POSE_KEPT_LIMIT]; /**< Columns whose texts are kept, in the order of the options. */
    size_t kept_count;
    double factor[ROLE_NAME]; /**< mm, degrees or seconds per unit of a column; 0: as it is. */
    bool is_mlapdv;           /**< x y z are ML, AP, DV from bregma, as IBL has them beside theta and phi. */
    struct space_words said;  /**< What titles, comments and headers say. */
    bool has_unit;            /**< The file names it, */
    bool is_own_unit;         /**< or the user. */
    size_t pairs; /**< From 1: the column that says whether a row is an entry or the target of its name (pairs_parse());
                     0 = none does. */
    size_t place, place_side; /**< From 1: the column of names of places, and one of their sides; 0 = none. Without a
                                 header each line is a place. */
    bool ends_at_target;      /**< Axes end there, not only point there (target_x, but not tx). */
    bool moves;               /**< Positions of MNI 305 are moved to MNI 152. */
    size_t heard_lines;       /**< Lines of the head, whose words are in @p said. */
    int grows;                /**< 1: header or lines say RAS, -1: LPS, and no row may say the other. */
};

/** Reads the head of a text: its first lines, @p all of them or TABLE_HEAD bytes. Fails with what it is
 * taken for, which roles were found in which columns, and all that is missing, or what its numbers cannot be. Notes
 * name the columns that have no role. *is_short: the head has no row yet. */
void columns_plan(struct job *job, struct columns *out, bool *is_short, struct text head,
                  const conus_pose_options *options);

/** The space of the rows that are read: MNI 152 of those that are moved there. */
struct pose_space columns_space(const struct columns *columns);

/** Refuses what the name of the file at @p path (NULL: none) says of axes or voxels where nothing in its @p head does,
 * nor a file beside it, which then @p is_said. */
void columns_check_name(struct job *job, const struct columns *columns, const char *path, struct text head,
                        const conus_pose_options *options, bool is_said);

/** Whether a line behind the head, a comment or words, says another space or unit than the rows were read in:
 * CONUS_ERROR_DATA. */
conus_status columns_hear_late(const struct columns *columns, struct text line, size_t number,
                               const conus_pose_options *options);

/** A row's name; "" if it gives none. */
struct pose_name {
    struct text text; /**< Inside the line, or here: */
    char own[POSE_ID_LIMIT + 1];
    struct kept_text place;                 /**< Where columns.place says so: the name, inside the line, */
    struct text side;                       /**< and what is said of its side. */
    struct kept_text kept[POSE_KEPT_LIMIT]; /**< Inside the line; text.data NULL: there is none. */
};

/** Whether a cell says nothing: n/a, NA, none, dashes. */
bool columns_is_absent(struct text cell);

/** Which end of an axis a cell of columns.pairs says that its row is. */
enum columns_end { END_NONE, END_ENTRY, END_TARGET };
enum columns_end columns_end_of(struct text cell);

/** Fails: so many of the axes are shorter than 1/20 of the @p longest edge. */
void columns_refuse_short(struct job *job, size_t count, size_t axes, double longest);

/** What a line is. */
enum columns_line {
    LINE_NOTHING, /**< Nothing, a comment, or of the head. */
    LINE_ROW,
    LINE_ABSENT,  /**< A row whose three coordinates are n/a. */
    LINE_CLOSING, /**< Mean, SD, Total, N. */
    LINE_AGAIN,   /**< The header again. */
    LINE_WORDS,   /**< Words without a number. */
    LINE_TITLE,   /**< Words and a number above rows that have no header. */
    LINE_OTHER,   /**< The header of another table. */
    LINE_KINDS
};

/** Says what the line is, and of a row gives @p row and @p name, with *bad set to what is wrong with it; NULL: only
 * says what it is. */
enum columns_line columns_read(conus_pose_row *row, struct pose_name *name, conus_status *bad,
                               const struct columns *columns, struct text line, size_t number,
                               const conus_pose_options *options);

/** Places that were found; begins as all 0. */
struct named_rows {
    struct name_set names; /**< By their place in @p items. */
    struct named_row {
        char *name;
        double point[3], outward[3]; /**< Outward of a position, else NaN. */
    } * items;
    size_t capacity;
};

void named_rows_finish(struct named_rows *known);

/** Puts a row where @p name says, as options->find_place() does, with notes of what else may be meant. Each name is
 * looked for once. CONUS_ERROR_MEMORY is no fault of the row. */
conus_status named_rows_find(conus_pose_row *row, struct named_rows *known, const struct pose_name *name,
                             const conus_pose_options *options, struct notes *notes);

/** Whether @p text is sixteen numbers and nothing else: then @p row or its error (in *bad) is the pose they are. */
bool columns_plain_matrix(conus_pose_row *row, conus_status *bad, struct text text, const conus_pose_options *options);

/** Adds the axes of a table with columns.pairs, in the order of their entries; each ends at its target. Fails where a
 * name has not one of each. */
void pairs_parse(const struct pose_reading *to, const struct columns *columns, struct text text);

enum { SIDES_SHAFTS = 64, SIDES_SHAFT_SIZE = 12 };

/** All 0: nothing was counted yet. */
struct sides {
    size_t left, right, left_on_right, right_on_left; /**< Points that a word calls so. */
    size_t ended[2], ended_wrong;                     /**< Names that end with L, with R ("M1L"); on the other side. */
    size_t points, beyond[2];                         /**< All, and those beyond the edge on the left and right. */
    struct shaft {
        char letters[SIDES_SHAFT_SIZE]; /**< "LPH" of "LPH 1". */
        size_t contacts, wrong;         /**< Wrong: on the other side than its first letter says. */
    } shafts[SIDES_SHAFTS];
    size_t shaft_count;
    bool has_others; /**< Names that end with a number and begin otherwise, or more shafts than these. */
};

/** The side that a name states by a word of its own: -1 left, +1 right, 0 none. */
int sides_of_name(struct text name);

/** The same of a file at @p path, NULL = none; a letter alone says nothing there ("peaks_R.csv"). */
int sides_of_file(const char *path);

/** Counts a point that is called @p name, and so or by a column on @p side; @p x mm from the middle, and wrong where
 * that is more than @p edge on the other side. Returns whether it is. */
bool sides_count(struct sides *sides, int side, struct text name, double x, double edge);

/** Fails where half of the points called left, or right, lie on the other side; @p why: what they may be; @p file: as
 * columns.file. */
void sides_check(struct job *job, const struct sides *sides, const char *why, const char *file);

/** Warns where half of the points, three at least, lie beyond the edge on the other side than their file's name says,
 * by @p of_file; and of shafts of electrodes (LA1, LPH-2) whose contacts, three at least, all lie on the other side
 * than the first letter says; and of names that end with L and with R, three at least, that all lie on the other side
 * ("M1L", "M1R"). A first letter says a side only where there is the same shaft of the other one (RPH), or where all
 * names with a number begin so: of both letters, or of three shafts. */
void sides_warn(struct job *job, const struct sides *sides, int of_file);

/* The cells of a program's table by the exact names of its columns, where nothing need be guessed. */

enum { NAMED_CELLS_MOST = 32 };

/** Which cells of a table a reader takes; others are passed over. */
struct named_cells {
    const char *const *names; /**< [count]; "a/b" is called a or b. */
    size_t count;             /**< At most NAMED_CELLS_MOST. */
    struct table table;       /**< What stands between cells. */
    size_t needed;            /**< Each row has cells of the first of them; 0: of all. */
    bool may_be_longer;       /**< Rows may have more cells than the header. */
    size_t at[NAMED_CELLS_MOST];
    struct text called[NAMED_CELLS_MOST]; /**< What the header has; borrowed. */
    size_t width;                         /**< Cells of the header. */
    struct table_line line;               /**< The row. */
};

/** Looks for the columns in the line @p header, which must live as long. One that is there twice is an error; @p job
 * NULL: it is not asked. */
void named_cells_find(struct job *job, struct named_cells *cells, struct text header);

/** Whether the table has this column. */
bool named_cells_has(const struct named_cells *cells, size_t column);

/** Takes a row to pieces, until the next one. An error where a cell that is needed is missing, where there are more
 * than in the header, or a quotation mark is not closed. */
void named_cells_split(struct job *job, struct named_cells *cells, struct text line);

/** The row's cell of @p column; empty where the table lacks it. */
struct text named_cell(const struct named_cells *cells, size_t column);

/** Whether it holds no value: empty, "n/a", "None", "(null)". */
bool named_cell_is_absent(const struct named_cells *cells, size_t column);

/** The numbers of @p count columns from @p first. */
void named_cells_numbers(struct job *job, double *out, const struct named_cells *cells, size_t first, size_t count);

#endif
