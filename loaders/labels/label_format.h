/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of label tables: what each is called, how its text is known and parsed. A format is detected from
 * the content, never from the name of the file. A new one is a source that defines its `struct label_format`, and a row
 * of LABEL_FORMATS. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FORMAT_H
#define CONUS_LOADERS_LABELS_LABEL_FORMAT_H

#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

/** What a text is in the rough: no format is asked about a text of another kind. */
enum label_kind {
    LABEL_MARKUP,  /**< Begins with "<". */
    LABEL_JSON,    /**< Begins with a brace or bracket. */
    LABEL_COLUMNS, /**< Lines below a header row that names a number and a name, or of number, comma, name. */
    LABEL_ROWS     /**< Lines of columns with white space between them. */
};

/** A text whose format is looked for. */
struct label_text {
    enum label_kind kind;
    struct text text;                  /**< Of markup and JSON without white space in front. */
    struct text root;                  /**< Markup: the outermost element. */
    bool has_header;                   /**< Columns: the first line has their names. */
    bool is_slicer;                    /**< Columns: one of the names is 3D Slicer's. */
    char separator;                    /**< Columns: what stands between them. */
    const struct label_census *census; /**< Rows: how many have which shape (label_rows.h). */
};

struct label_format {
    const char *name; /**< In words, for messages and "where the names come from". */
    enum label_kind kind;
    bool (*is)(const struct label_text *text);
    /** Appends the table in @p text to @p out, in any order; label 0 is dropped. */
    void (*parse)(struct job *job, struct label_table *out, struct text text, const struct label_use *use);
    const struct label_rows *rows; /**< In place of these two functions (label_rows.h); NULL: they are there. */
    const char *endings; /**< Of files beside a volume X in which it is looked for: ".tsv"; NULL = those of others. */
};

/** The formats. The first that knows a text is its own; files beside a volume are tried in the order of their endings
 * here. */
#define LABEL_FORMATS(ROW)                                                                                             \
    ROW(label_format_pairs)                                                                                            \
    ROW(label_format_aal)                                                                                              \
    ROW(label_format_colours)                                                                                          \
    ROW(label_format_bids)                                                                                             \
    ROW(label_format_ome)                                                                                              \
    ROW(label_format_structures)                                                                                       \
    ROW(label_format_data_set)                                                                                         \
    ROW(label_format_segments)                                                                                         \
    ROW(label_format_niivue)                                                                                           \
    ROW(label_format_map)                                                                                              \
    ROW(label_format_objects)                                                                                          \
    ROW(label_format_itk_snap)                                                                                         \
    ROW(label_format_mrtrix)                                                                                           \
    ROW(label_format_slicer)                                                                                           \
    ROW(label_format_freesurfer)                                                                                       \
    ROW(label_format_afni)                                                                                             \
    ROW(label_format_slicer_csv)                                                                                       \
    ROW(label_format_csv)                                                                                              \
    ROW(label_format_bare)                                                                                             \
    ROW(label_format_fsleyes)                                                                                          \
    ROW(label_format_plain)                                                                                            \
    ROW(label_format_spm)                                                                                              \
    ROW(label_format_fsl)                                                                                              \
    ROW(label_format_workbench)

#define LABEL_FORMAT_DECLARE(name) extern const struct label_format name;
LABEL_FORMATS(LABEL_FORMAT_DECLARE)

/** A table with any separator, whose header row has the columns that label_use.columns gives. */
extern const struct label_format label_format_chosen;

/** Whether the text of @p about is of LABEL_COLUMNS; fills what those have. */
bool label_columns_look(struct label_text *about);

/** Fails with the columns that the first row of @p text has and those that are needed, unless it has no two. */
void label_columns_refuse(struct job *job, struct text text);

/** The endings of tables, with '/' between them, in the order in which files beside a volume are tried. */
const char *label_endings(struct job *job);

/** The format of @p text, which text_from_bytes() gave, or NULL. */
const struct label_format *label_format_of(struct text text);

/** As label_format_of(), but for the voxels of @p use a list of names, too: as many as they have labels, 1, 2, 3, ....
 */
const struct label_format *label_format_for(struct text text, const struct label_use *use);

/** How many lines of @p text are names without a number, if all that are no comments are; else 0. */
size_t label_lines_count(struct text text);

/** Appends these lines to @p out, from 1. */
void label_lines_parse(struct job *job, struct label_table *out, struct text text, const struct label_use *use);

enum { LABEL_LUT_SIZE = 768 }; /**< MRIcron's .lut: 256 red, 256 green, 256 blue bytes. */
bool label_is_lut(const uint8_t *data, size_t size);

/** Colours the entries of @p table with numbers below 256. */
void label_lut_apply(struct label_table *table, const uint8_t *lut);

/** Parses @p text as @p format into the empty @p out, sorted, which may stay empty. */
void label_text_parse(struct job *job, struct label_table *out, const struct label_format *format, struct text text,
                      const struct label_use *use);

/** Fails where the table calls 0 an area, does not name all labels of the voxels, and would if each number were one
 * more: it counts from 0, or has another volume's names. Nothing where @p voxels is NULL. */
void label_check_zero(struct job *job, const struct label_table *table, const struct label_voxels *voxels);

/** Parses a label table of any known format for @p use into the empty @p out, sorted; *format is its name in words
 * ("ITK-SNAP labels"), static. CONUS_ERROR_DATA when the bytes are of no known format or damaged. Outputs are untouched
 * on failure. */
void label_bytes_parse(struct job *job, struct label_table *out, const char **format, const uint8_t *data, size_t size,
                       const struct label_use *use);

#endif
