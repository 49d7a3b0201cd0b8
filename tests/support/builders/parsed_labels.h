/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A label table parsed from a literal, and shown as one. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_PARSED_LABELS_H
#define CONUS_TESTS_SUPPORT_BUILDERS_PARSED_LABELS_H

#include "base/files/file.h"
#include "loaders/labels/label_format.h"

struct parsed {
    struct label_table table;
    struct notes notes;
    const char *format;
};

/** A text in a format, and its table as parsed_text() shows it. */
struct sample {
    const char *format, *text, *table;
};

conus_status parsed_from(struct parsed *out, const char *text);
/** The same of @p bytes for @p use. @p out is untouched on failure, but for notes. */
conus_status parsed_from_bytes(struct parsed *out, const struct bytes *bytes, const struct label_use *use);
void parsed_finish(struct parsed *parsed);

/** "1 Precentral_L (PRE) #0a0b0c L <7; 2 ...": number, name, abbreviation, colour, hemisphere, parent. Static. */
const char *parsed_text(const struct label_table *table);

bool notes_have(const struct notes *notes, const char *part);

/** Fails the test unless @p text is refused as damaged, with @p message in the message. */
void assert_refused(const char *text, const char *message);

/** Asserts that each sample gives its format and table, that each of its prefixes is read or refused, and that each
 * allocation, and each primitive of a job, may fail. */
void assert_samples(const struct sample *samples, size_t count);

#endif
