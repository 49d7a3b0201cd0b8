/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A label table from bytes: the format is detected from the content, never from the name of the file. */
#ifndef CONUS_LOADERS_LABELS_LABEL_BYTES_H
#define CONUS_LOADERS_LABELS_LABEL_BYTES_H

#include "loaders/labels/label_format.h"
#include "loaders/labels/label_use.h"

/** The format of @p text, which text_from_bytes() gave, or NULL. */
const struct label_format *label_format_of(struct text text);

/** A table of whatever separator, of which label_use.columns says what number and name are. */
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
