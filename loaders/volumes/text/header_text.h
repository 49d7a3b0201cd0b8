/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Headers of text, by tables: a row says how a key is written, how its value is, and where in the format's own
 * struct that goes. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_HEADER_TEXT_H
#define CONUS_LOADERS_VOLUMES_TEXT_HEADER_TEXT_H

#include "base/job/reader.h"

enum {
    HEADER_TEXT_LIMIT = 1 << 24, /**< Bytes of a header of text. */
    HEADER_LINE_LIMIT = 1 << 16, /**< Lines of it.               */
    HEADER_SHOWN = 60,           /**< Bytes of a value in a message. */
    HEADER_ROW_LIMIT = 40,       /**< Rows of a table. */
    HEADER_LIST_LIMIT = 4        /**< Numbers of a list. */
};

/** Arguments for "%.*s": the beginning of the text @p t. */
#define HEADER_SHOW(t) TEXT_SHOW(t, HEADER_SHOWN)

/** How a value is written, and the member that it becomes. */
enum header_kind {
    HEADER_TEXT,     /**< struct text, the job's. */
    HEADER_WORD,     /**< int: the value of one of row.words. */
    HEADER_INTEGER,  /**< int64_t, row.least or more. */
    HEADER_INTEGERS, /**< struct header_list of such. */
    HEADER_NUMBER,   /**< double */
    HEADER_UNUSED    /**< Not looked at. */
};

struct header_word {
    const char *names; /**< With '/' between them; NULL ends the list. */
    int value;
};

struct header_list {
    int64_t values[HEADER_LIST_LIMIT];
    size_t count;
};

/** A key, which may stand only once. What a header does not say stays as it is in the struct. */
struct header_row {
    const char *names; /**< With '/' between them; messages use the first. */
    enum header_kind kind;
    size_t place;        /**< Offset in the struct. */
    const char *missing; /**< The message where the key is missing; NULL: it may be missing. */
    const struct header_word *words;
    const char *allowed;  /**< "allowed are ...": of words. */
    conus_status refused; /**< The status for a word that is not in the table; 0 = CONUS_ERROR_DATA. */
    bool exact;           /**< Upper and lower case of words differ. */
    int64_t least;
    /** Called after the value is taken, also where the key is missing (value.data NULL); NULL = nothing to do. */
    void (*check)(struct job *job, void *header, struct text value);
};

struct header_table {
    const struct header_row *rows;
    size_t count;
    bool exact; /**< Upper and lower case of keys differ. */
};

/** The value of each row, the job's; data is NULL where it is missing. */
struct header_values {
    struct text of[HEADER_ROW_LIMIT];
};

/** The next line, as of reader_line(); false at the end. @p count counts the lines, at most HEADER_LINE_LIMIT. */
bool header_line(struct reader *r, struct text *line, size_t *count);

/** Puts a copy of @p value into the row of the key @p name; false where there is none. */
bool header_keep(struct job *job, struct header_values *values, const struct header_table *table, struct text name,
                 struct text value);

/** Whether there is a value of the row whose first name is @p name. */
bool header_has(const struct header_values *values, const struct header_table *table, const char *name);

/** Reads the values into the format's struct @p header, row by row. */
void header_take(struct job *job, void *header, const struct header_table *table, const struct header_values *values);

/** The value of the word that is @p text; -1 if none is. */
int header_word(const struct header_word *words, struct text text, bool exact);

/** Puts a copy of @p value into @p slot, which must be empty (data NULL): a key may stand only once. */
void header_once(struct job *job, struct text *slot, struct text value, struct text name);

/** An error if @p value has no data: "type: missing, ALLOWED". */
void header_need(struct job *job, struct text value, const char *name, const char *allowed);

/** Exactly @p count numbers with white space between them. */
void header_numbers(struct job *job, double *out, size_t count, struct text value, const char *name);

/** A whole number from @p least to 2^62. */
int64_t header_integer(struct job *job, struct text value, int64_t least, const char *name);

/** The name of the voxels' file, which must lie in the header's folder or below it. A list or pattern of files, as
 * "LIST" (with @p exact in capitals only) and "%03d.raw 1 9 1" are, is CONUS_ERROR_UNSUPPORTED: "@p name: found ...,
 * @p allowed". */
char *header_file(struct job *job, struct text value, const char *name, const char *allowed, bool exact);

/** Millimetres in a unit ("mm", "um", "micron"), 0 if it is not known. */
double header_unit(struct text unit);

/** Turns the signs of x and y of @p m, a matrix of points: LPS becomes RAS. */
void header_turn_lps(double m[16]);

#endif
