/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of label tables: what each is called, how its text is known and parsed. A format is detected from
 * the content, never from the name of the file. A new one is a row of the table in label_bytes.c, and a function that
 * parses it where no other does. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FORMAT_H
#define CONUS_LOADERS_LABELS_LABEL_FORMAT_H

#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

/** What a text is in the rough: no format is asked about a text of another kind. */
enum label_kind {
    LABEL_MARKUP,  /**< Begins with "<". */
    LABEL_JSON,    /**< Begins with a brace or bracket. */
    LABEL_COLUMNS, /**< Lines below a header row that names a number and a name, */
    LABEL_BARE,    /**< or of number, comma, name. */
    LABEL_ROWS,    /**< Lines of columns with white space between them. */
    LABEL_CHOSEN,  /**< A table with any separator, whose header row has the columns that label_use.columns gives. */
    LABEL_LINES,   /**< As many names as a volume has labels, 1, 2, 3, .... */
    LABEL_PALETTE  /**< Bytes that are no text: MRIcron's .lut, of 256 red, 256 green, 256 blue ones. */
};

/** A text whose format is looked for. */
struct label_text {
    enum label_kind kind;
    struct text text;                  /**< Of markup and JSON without white space in front. */
    struct text root;                  /**< Markup: the outermost element. */
    struct text header;                /**< Columns: the first line, with their names, */
    char separator;                    /**< and what stands between them. */
    const struct label_census *census; /**< Rows: how many have which shape (label_rows.h). */
};

/** Appends the table in @p text to @p out, in any order; label 0 is dropped. */
typedef void label_parse(struct job *job, struct label_table *out, struct text text, const struct label_use *use);
label_parse label_parse_afni, label_parse_bare, label_parse_data_set, label_parse_fsl, label_parse_lists,
    label_parse_map, label_parse_objects, label_parse_ome, label_parse_segments, label_parse_structures,
    label_parse_table, label_parse_workbench;

/** Whether the JSON @p text is such a table. */
typedef bool label_is(const struct label_text *text);
label_is label_is_data_set, label_is_map, label_is_objects, label_is_structures;

/** A row: what it has must all hold, and one of the last two parses it. */
struct label_format {
    const char *name; /**< In words, for messages and "where the names come from". */
    enum label_kind kind;
    const char *begins;   /**< Its first character is one of these. */
    const char *roots;    /**< Its outermost element is one of these, '/' between them. */
    const char *mentions; /**< All these, '/' between them, are in it. */
    const char *header;   /**< This is in its header row. */
    char separator;
    label_is *is;
    bool is_colours; /**< Numbers and colours without names, which go to the areas of another table. */
    label_parse *parse;
    const struct label_rows *rows; /**< label_rows.h */
    const char *endings; /**< Of files beside a volume X in which it is looked for: ".tsv"; NULL = those of others. */
};

/** Fills what columns have; the kind is LABEL_COLUMNS, LABEL_BARE, or LABEL_ROWS where it has none. */
void label_columns_look(struct label_text *about);

/** Fails with the columns that the first row of @p text has and those that are needed, unless it has no two. */
void label_columns_refuse(struct job *job, struct text text);

/** The endings of tables, or only of colours, with '/' between them, in the order in which files beside a volume are
 * tried. */
const char *label_endings(struct job *job, bool only_colours);

/** The format of @p text, which text_from_bytes() gave, or NULL. */
const struct label_format *label_format_of(struct text text);

/** The format of @p file for @p use, or NULL; *text is what it parses. */
const struct label_format *label_format_for(struct text *text, const struct bytes *file, const struct label_use *use);

/** How many lines of @p text are names without a number, if all that are no comments are; else 0. */
size_t label_lines_count(struct text text);

/** Appends these lines to @p out, from 1. */
label_parse label_parse_lines;

/** Parses @p text as @p format into the empty @p out, sorted, which may stay empty. */
void label_text_parse(struct job *job, struct label_table *out, const struct label_format *format, struct text text,
                      const struct label_use *use);

/** Fails where the table calls 0 an area, does not name all labels of the voxels, and would if each number were one
 * more: it counts from 0, or has another volume's names. Nothing where @p voxels is NULL. */
void label_check_zero(struct job *job, const struct label_table *table, const struct label_voxels *voxels);

/** Parses a label table of any known format for @p use into the empty @p out, sorted; *format is its name in words
 * ("ITK-SNAP labels"), static. CONUS_ERROR_DATA when the bytes are of no known format or damaged. Outputs are untouched
 * on failure. */
void label_bytes_parse(struct job *job, struct label_table *out, const char **format, const struct bytes *file,
                       const struct label_use *use);

#endif
