/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of label tables: what each is called, how its text is known and parsed. A format is detected from
 * the content, never from the name of the file. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FORMAT_H
#define CONUS_LOADERS_LABELS_LABEL_FORMAT_H

#include "atlas/labels/labels.h"
#include "loaders/labels/label_use.h"

/** A format of label tables. */
struct label_format {
    const char *name; /**< In words, for messages and "where the names come from". */
    /** Appends the table in @p text to @p out, in any order; label 0 is dropped. */
    conus_status (*parse)(struct label_table *out, struct text text, struct notes *notes);
    /** Likewise, where the purpose matters; NULL: it does not. */
    conus_status (*parse_for)(struct label_table *out, struct text text, const struct label_use *use,
                              struct notes *notes);
};

/** The format of @p text, lines below a header row, by its content; NULL if it is none. */
const struct label_format *label_format_of_columns(struct text text);

/** Fails with the columns that the first row of @p text has and those that are needed; CONUS_OK where it has no two.
 */
conus_status label_columns_refuse(struct text text);

/** FSLeyes's colours without names: it names nothing. */
extern const struct label_format label_format_colours;

/** The format of @p text, lines of columns, by its content; NULL if it is none. */
const struct label_format *label_format_of_rows(struct text text);

/** The format of @p text, which begins with a brace or bracket, by its content; NULL if it is none. */
const struct label_format *label_format_of_json(struct text text);

extern const struct label_format label_format_afni;

/** The format of @p text, which begins with "<", by its content; NULL if it is none. */
const struct label_format *label_format_of_markup(struct text text);

extern const struct label_format label_format_workbench;
extern const struct label_format label_format_fsl;
extern const struct label_format label_format_spm; /**< SPM's and CAT12's atlas XML. */

/** The format of @p text, which text_from_bytes() gave, or NULL. */
const struct label_format *label_format_of(struct text text);

/** A table with any separator, whose header row has the columns that label_use.columns gives. */
extern const struct label_format label_format_chosen;

enum { LABEL_LUT_SIZE = 768 }; /**< MRIcron's .lut: 256 red, 256 green, 256 blue bytes. */
bool label_is_lut(const uint8_t *data, size_t size);

/** Colours the entries of @p table with numbers below 256. */
void label_lut_apply(struct label_table *table, const uint8_t *lut);

/** Parses @p text as @p format into a sorted table, which may turn out empty. */
conus_status label_text_parse(struct label_table *out, const struct label_format *format, struct text text,
                              const struct label_use *use, struct notes *notes);

/** Parses a label table of any known format for @p use; *format is its name in words ("ITK-SNAP labels"), static.
 * @p out is sorted, and the caller's to finish. CONUS_ERROR_DATA when the bytes are of no known format or damaged. */
conus_status label_bytes_parse(struct label_table *out, const char **format, const uint8_t *data, size_t size,
                               const struct label_use *use, struct notes *notes);

#endif
