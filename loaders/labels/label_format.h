/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of label tables: their list, entries and cells for all, rows, and FreeSurfer's names. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FORMAT_H
#define CONUS_LOADERS_LABELS_LABEL_FORMAT_H

#include "base/formats/xml.h"
#include "loaders/labels/labels.h"

/* The formats of label tables: what each is called, how its text is known and parsed. A format is detected from the
 * content, never from the name of the file. A new one is a row of the table in label_bytes.c, and a function that
 * parses it where no other does. */

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
    const struct label_census *census; /**< Rows: how many have which shape (label_rows.c). */
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
    const struct label_rows *rows; /**< label_rows.c */
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

/** Parses a label table of any known format for @p use into the empty @p out, sorted; *format is its name in words
 * ("ITK-SNAP labels"), static. CONUS_ERROR_DATA when the bytes are of no known format or damaged. Outputs are untouched
 * on failure. */
void label_bytes_parse(struct job *job, struct label_table *out, const char **format, const struct bytes *file,
                       const struct label_use *use);

/* Entries of label tables and their cells, for all formats. Where a cell stands ("line 7") is the job's place. */

/** An entry while it is read. */
struct label_row {
    struct label label;             /**< Without texts. */
    struct text name, abbreviation; /**< As they are written. */
    bool underscores;               /**< In the name, where spaces are meant. */
};

/** Appends the entry of @p row. Label 0 is background: only its name is kept (the first), with a note where its name
 * does not say so: a table that counts from 0 names every area wrongly. */
void labels_keep(struct job *job, struct label_table *table, const struct label_row *row);

/** Whether @p name says that what is called so is no area: "unknown", "Air", "*.*.*". */
bool label_is_background(struct text name);

/** Takes the first label out of @p table, whose numbers are those of volumes from 1, where that is volume 0 and is
 * called background; a note says so. Whether it did. */
bool label_drop_background(struct job *job, struct label_table *table);

/** Number and colour of Workbench's and GIFTI's <Label Key= Red= Green= Blue=>; its name is the element's text. */
void label_element(struct job *job, struct label *out, const struct xml_event *event);

/** A <Label> of GIFTI or CIFTI while it is open, whose number may be below 0. */
struct label_entry {
    struct label label;
    bool negative;
};

/** At its start tag, whose line is the caller's place. */
void label_entry_start(struct job *job, struct label_entry *entry, const struct xml_event *event);

/** At its end tag, with the name in between: appends it to @p table. 0 and what lies below stand for no area; a note
 * says so where the name does not. The entry is empty afterwards. */
void label_entry_end(struct job *job, struct label_entry *entry, struct label_table *table, struct text name);

/** Parses a table whose numbers stand in candidate @p number of several into @p out, and gives what that is called;
 * empty where there is no such one. */
typedef struct text label_trial(struct job *job, struct label_table *out, void *user, size_t number);

/** The candidate of @p count whose table names most labels of the voxels; of equal ones the first. One that cannot be
 * parsed names none. @p usual is the one that is taken without voxels, and where none names any; a note tells another.
 */
size_t label_choose(struct job *job, size_t usual, label_trial *trial, void *user, size_t count,
                    const struct label_voxels *voxels);

/** @name Values of cells; 0 and a failure where a cell has none @{ */
uint32_t label_cell_number(struct job *job, struct text cell);
/** Whether it is a whole number below 2^32, perhaps written as "17.0"; no failure. */
bool label_cell_whole(struct text cell, uint64_t *number);
typedef uint8_t label_cell_part(struct job *job, struct text cell, const char *channel);
label_cell_part label_cell_channel;  /**< From 0 to 255. */
label_cell_part label_cell_fraction; /**< From 0 to 1. */
/** Red, green, blue by @p part. */
void label_cell_rgb(struct job *job, struct label *label, const struct text cells[3], label_cell_part *part);
/** "#rrggbb", "rrggbb", "rgb(R,G,B)" or "rgba(R,G,B,A)". */
void label_cell_colour(struct job *job, uint8_t out[3], struct text cell);
/** The colour of a column that is called so, by label_cell_rgb(), or without @p part of one cell. What is none is
 * bad_rgb, no failure: a colour is not worth a table. */
void label_colour(struct job *job, struct label *label, const struct text *cells, label_cell_part *part);
/** 'L', 'R', 'B' from the usual words for them, 0 from any other. */
char label_hemisphere_of(struct text cell);
/** @} */

/* Formats of label tables in rows, with white space between the columns: values instead of functions. */

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

/* FreeSurfer's names, for its volumes away from its colour table. */

/** Appends those labels of @p voxels to @p out that FreeSurfer's table has. */
void freesurfer_names_add(struct job *job, struct label_table *out, const struct label_voxels *voxels);

#endif
