/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Formats of label tables in rows, with white space between the columns: values instead of functions. */
#ifndef CONUS_LOADERS_LABELS_LABEL_ROWS_H
#define CONUS_LOADERS_LABELS_LABEL_ROWS_H

#include "loaders/labels/label_format.h"

/** Shapes of rows, of which a format's has one. */
enum label_shape {
    SHAPE_PAIRS,       /**< Alternately a name and five numbers. */
    SHAPE_NUMBER_LAST, /**< One or two words and a number. */
    SHAPE_UNNAMED,     /**< A number that grows, and numbers from 0 to 1. */
    SHAPE_ITK_SNAP,    /**< Seven numbers and a quotation mark. */
    SHAPE_MRTRIX,      /**< A number, two words, four numbers or more. */
    SHAPE_COLOURED,    /**< A number, words, three numbers or more. */
    SHAPE_FSLEYES,     /**< Four numbers or more, and words. */
    SHAPE_NAMED,       /**< A number and words. */
    SHAPES
};

struct label_census {
    size_t rows, of[SHAPES]; /**< All rows, and those that have each shape. */
    size_t coded, own;       /**< Rows of a number, a word and a number; and those where both numbers are one. */
    bool with_alpha;         /**< A coloured row has four numbers. */
    bool tabbed;             /**< A tab behind every first word and no other: the name is all the rest. */
};

struct label_census label_rows_count(struct text text);

/** A format of rows: a number, other numbers, a name, other numbers. */
struct label_rows {
    enum label_shape shape;
    bool everywhere;   /**< All rows have it, else most. */
    const char *says;  /**< What the first line says, a comment; NULL = nothing. */
    size_t lead;       /**< Numbers before the name, */
    bool colours_last; /**< or behind it: R G B, or R G B A if a row has four. */
    bool fractions;    /**< Colours are 0 to 1, else 0 to 255. */
    bool is_plain;     /**< No numbers but for a code behind the name, and the name may stand in quotation marks. */
    bool coded;        /**< There is such a code; label_rows_parse() finds out, */
    bool own;          /**< or that some rows have their own number there, */
    bool further;      /**< or that numbers follow R G B A, */
    bool columns;      /**< or stand in columns behind the name. */
    bool quoted;       /**< The name stands in quotation marks. */
    bool two_names;    /**< Abbreviation and name, if all abbreviations differ. */
    bool unnamed;      /**< There is no name. */
    bool name_above;   /**< The name is the line before. */
    bool number_last;  /**< Abbreviation, name, number. */
    bool underscores;  /**< In names, where spaces are meant. */
};

/** Whether the text has that format. */
bool label_rows_are(const struct label_text *text, const struct label_rows *rows);

void label_rows_parse(struct job *job, struct label_table *out, struct text text, const struct label_rows *rows);

#endif
