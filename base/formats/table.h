/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Delimited text of numbers, as programs, spreadsheets and people write it: lines, cells, and what separates
 * them. Nothing is allocated, and nothing is known of what the cells mean. */
#ifndef CONUS_BASE_FORMATS_TABLE_H
#define CONUS_BASE_FORMATS_TABLE_H

#include "base/text.h"

enum {
    TABLE_CELLS = 1000, /**< Most cells of a line. */
    TABLE_HEAD = 65535  /**< As much of a text as table_decide() looks at, in bytes. */
};

/** What stands between cells, in the order in which ties are decided. */
enum table_separator {
    TABLE_TABS,
    TABLE_SEMICOLONS,
    TABLE_PIPES, /**< Also before the first and behind the last cell, as in Markdown. */
    TABLE_COMMAS,
    TABLE_BLANKS, /**< Two blanks or more. */
    TABLE_SPACES, /**< Any white space. */
    TABLE_SEPARATORS
};

/** What a comma within a number is, as the numbers of the head show. */
enum table_comma {
    TABLE_COMMA_UNKNOWN = 0, /**< No number has one. */
    TABLE_COMMA_DECIMAL,
    TABLE_COMMA_THOUSANDS,
    TABLE_COMMA_UNCLEAR /**< All have exactly three digits behind it: 1,250. Or numbers contradict each other. */
};

struct table {
    enum table_separator separator;
    enum table_comma comma;
    bool quotes_are_plain; /**< Quotation marks belong to the cell (BIDS). */
    size_t cells;          /**< Of most lines that have three numbers; 0 = no line has. */
    size_t first;          /**< Number of the first line with that many cells and three numbers, from 1. */
};

/** A line by its cells, without white space around them. */
struct table_line {
    struct text cells[TABLE_CELLS];
    size_t count;
    size_t given;       /**< Without empty cells at the end. */
    struct text spoilt; /**< The first cell with a quotation mark that is not closed or stands in its middle; */
    bool is_unclosed;   /**< which of the two. spoilt.data is NULL where there is none. */
};

/** Finds what separates the cells of @p head, the first whole lines of a text: that by which most lines have the same
 * number of cells, at least three of which are numbers. A line `sep=;` decides itself. */
void table_decide(struct table *out, struct text head);

/** Takes a line to pieces. False for more than TABLE_CELLS cells. */
bool table_split(struct table_line *out, const struct table *table, struct text line);

/** How many cells are numbers. */
size_t table_numbers(const struct table_line *line);

/** Adds to table->comma what the comma of a cell says, if that is a number. */
void table_add_comma(struct table *table, struct text cell);

/** A number as tables have them: with a typographic minus (U+2212, U+2013, U+2011, U+00AD) before a digit, between
 * no-break and thin spaces, with the table's comma. False for anything else, and for 42.000 where a comma is decimal;
 * NaN and infinities are numbers. */
bool table_number(double *out, const struct table *table, struct text cell);

/** Whether a line is a comment (#, %, //): @p inside is what is behind the mark. */
bool table_is_comment(struct text *inside, struct text line);

/** Whether a line holds nothing: white space and separators, a rule of dashes, `sep=;`. */
bool table_is_blank(struct text line);

/** Takes lines up to the next one that is neither blank nor a comment; false where there is none. @p number of the line
 * before becomes that of the line; NULL: not wanted. */
bool table_next_line(struct text *rest, struct text *line, size_t *number);

/** Without white space, no-break and thin spaces at both ends. */
struct text table_trim(struct text text);

#endif
