/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the parsers of label tables share. Only loaders/label_*.c include it, and GIFTI. */
#ifndef CONUS_LOADERS_LABELS_LABEL_PARSE_H
#define CONUS_LOADERS_LABELS_LABEL_PARSE_H

#include "atlas/labels.h"
#include "base/xml.h"
#include "loaders/labels/label_use.h"

/** A format of label tables. */
struct label_format {
    const char *name; /**< In words, for messages and "where the names come from". */
    /** Appends the table in @p text to @p out, in any order; label 0 is dropped. */
    conus_status (*parse)(struct label_table *out, struct text text, struct notes *notes);
};

/** What @p text is by its content, or NULL: each looks at one family. */
const struct label_format *label_format_of_rows(struct text text);    /**< White space between columns. */
const struct label_format *label_format_of_columns(struct text text); /**< A header row; tabs or commas.  */
const struct label_format *label_format_of_markup(struct text text);  /**< XML and AFNI's NIML.           */
const struct label_format *label_format_of_json(struct text text);
/** ... and of all of them; @p text is without byte order mark and without NULs or white space at its end. */
const struct label_format *label_format_of(struct text text);

/** @p data as text: byte order mark, and NULs and white space at the end, cut off. */
struct text label_text_of(const uint8_t *data, size_t size);

enum { LABEL_LUT_SIZE = 768 }; /**< MRIcron's .lut: 256 red, 256 green, 256 blue bytes. */
bool label_is_lut(const uint8_t *data, size_t size);

/** Colours the entries of @p table with numbers below 256. */
void label_lut_apply(struct label_table *table, const uint8_t *lut);

/** Parses @p text as @p format into a sorted table, which may turn out empty. */
conus_status label_text_parse(struct label_table *out, const struct label_format *format, struct text text,
                              const struct label_use *use, struct notes *notes);

extern const struct label_format label_format_workbench;
extern const struct label_format label_format_afni;
extern const struct label_format label_format_fsl;

/** Workbench's table of volume @p volume of a 4-D file; label_format_workbench takes the first. */
conus_status label_workbench_parse(struct label_table *out, struct text text, size_t volume, struct notes *notes);

/** An FSL atlas XML's, numbered as for @p use (fsl_atlas.h); label_format_fsl goes by its type. */
conus_status label_fsl_parse(struct label_table *out, struct text text, const struct label_use *use,
                             struct notes *notes);

/** Appends @p label, if filling it gave @p status CONUS_OK; else returns @p status. Its strings are taken over in any
 * case. Label 0 is background and dropped, with a note where its name does not say so: a table that counts from 0
 * names every area wrongly. */
conus_status label_keep(struct label_table *table, struct label *label, conus_status status, struct notes *notes);

/** Whether @p name says that what is called so is no area: "unknown", "Air", "*.*.*". */
bool label_is_background(struct text name);

/** Number and colour of Workbench's and GIFTI's <Label Key= Red= Green= Blue=>; its name is the element's text. */
conus_status label_element(struct label *out, const struct xml_event *event);

/** Values of cells. @p where ("line 7", "entry 3") starts the message. */
conus_status label_cell_number(uint32_t *out, struct text cell, const char *where);
conus_status label_cell_channel(uint8_t *out, struct text cell, const char *channel, const char *where);
conus_status label_cell_fraction(uint8_t *out, struct text cell, const char *channel, const char *where);
/** "#rrggbb" or "rrggbb". */
conus_status label_cell_hex(uint8_t out[3], struct text cell, const char *where);
/** 'L', 'R', 'B' from the usual words for them, 0 from any other. */
char label_hemisphere_of(struct text cell);
/** Red, green, blue by @p parse_channel (one of the two above). */
conus_status label_cell_rgb(struct label *label, const struct text cells[3],
                            conus_status (*parse_channel)(uint8_t *, struct text, const char *, const char *),
                            const char *where);

#endif
