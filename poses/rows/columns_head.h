/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The head of a table while its columns are found, and what reads it: the parts of columns.h. */
#ifndef CONUS_POSES_ROWS_COLUMNS_HEAD_H
#define CONUS_POSES_ROWS_COLUMNS_HEAD_H

#include "base/memory.h"
#include "poses/rows/columns.h"

/** What three columns that differ only in x y z are, by the words that stand with the letter. The last of several
 * counts. */
enum family_kind {
    NEUTRAL,
    CENTRE,      /**< Behind a peak. */
    OF_SPACE,    /**< Of a template's space. */
    OTHER_SPACE, /**< Of another one, or voxels. */
    STATISTIC,
    ENTRY,
    TARGET,
    AIM, /**< What was aimed at. */
    DIRECTION,
    UP,
    QUATERNION,
    TURNED,
    UNKNOWN
};

#define COLUMN_NONE SIZE_MAX /**< The number of a column that is missing. */

struct family {
    char stem[COLUMN_NAME_SIZE];
    enum family_kind kind;
    size_t at[3]; /**< Or COLUMN_NONE. */
    bool is_peak, is_lps;
    bool has_letters; /**< r a s or l p s: it says which. */
};

enum { COLUMN_FAMILIES = 64, MATRIX_NUMBERS = 16 };

/** A row of the head, with three numbers at least. */
struct head_row {
    const struct text *cells;
    size_t count;
};

/** How many cells of a column of the head's rows are such. */
struct column_cells {
    size_t filled, given;         /**< Not empty; not absent (columns_is_absent()). */
    size_t numbers, zeros, longs; /**< Longs: longer than the atlas as mm, which they were not as um. */
    size_t units, voxels;         /**< Words of these. */
    size_t spaces, strong;        /**< Words of a space; and those without another meaning. */
    size_t sides, middles;        /**< Left or right; neither or both. */
    size_t ends[3];               /**< By enum columns_end. */
};

struct head {
    struct job *job;
    struct table_line line; /**< The header, */
    struct text beside[2];  /**< without these words in front and behind. */
    struct head_row *rows;
    size_t row_count, row_capacity;
    struct column_cells cells[TABLE_CELLS]; /**< Of their columns. */
    bool is_on_its_side;                    /**< Rows are called x, y and z. */
    bool has_axes;                          /**< Brackets say where x, y and z grow: */
    int side;                               /**< 1 as in RAS, -1 as in LPS, as --space may, too; 0 unsaid. */
    bool lacks_space;                       /**< It has AP, ML and DV, which --space does not. */
    char names[TABLE_CELLS][COLUMN_NAME_SIZE];
    double unit[TABLE_CELLS]; /**< mm, as space_unit_mm(). */
    struct family families[COLUMN_FAMILIES];
    size_t family_count;
    struct buffer faults; /**< One after the other, "; " between. */
    struct columns *out;
    const conus_pose_options *options;
    struct columns_words words;
    struct family named; /**< By the user's words, or BIDS's. */
    bool is_named;       /**< By the user's. */
    struct text text;
};

/** Sets in head->out what lines and columns say of the space and unit of positions; the user's word beats it, and a
 * column of LPS or RAS beats --space. Fails where positions cannot be taken. */
void columns_hear_words(struct head *head);

/** Judges the numbers of the head's rows. The unit that the user or the file states is not questioned. */
void columns_check_numbers(const struct head *head);

/** Adds a fault to those that there are. */
#define FAULT(head, ...)                                                                                               \
    (buffer_text(&(head)->faults, (head)->faults.size ? "; " : ""), buffer_format(&(head)->faults, __VA_ARGS__))
#define FAULT_IF(is_one, ...) ((is_one) ? FAULT(__VA_ARGS__) : (void)0)

/** Looks for names of places in options->atlas where no column has coordinates: sets out->place, or adds faults.
 * @p words: what a header calls a column of names. */
void columns_find_places(struct head *head, const char *words);

/** @name Lines
 * @{ */

/** A cell of head->rows; "" where the line ends before it. */
struct text columns_cell(const struct head *head, size_t row, size_t column);

bool columns_has_digit(struct text line);

/** Whether a line has several words and too few cells for a row: "Note. Talairach coordinates, p < 0.05." */
bool columns_is_sentence(const struct columns *columns, struct text text);

/** By which the header is known again. */
uint64_t columns_sum(struct text text);

/** Reads a line without a header, separated as the rest of the text is, or else by white space or commas. False with a
 * message. */
bool columns_point(double point[3], struct text *name, const struct table *table, struct text line);

/** mm per unit of a space. */
double columns_space_mm(conus_space space);
/** @} */

#endif
