/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Text files with one changed place. */
#ifndef CONUS_TESTS_SUPPORT_BUILDERS_BENT_TEXT_H
#define CONUS_TESTS_SUPPORT_BUILDERS_BENT_TEXT_H

#include "base/buffer.h"
#include "loaders/volumes/text/text_volume.h"

/** Appends @p text to @p out, with @p to in place of the first @p from, which must be there; NULL changes nothing. */
void append_bent(struct buffer *out, const char *text, const char *from, const char *to);

/** Fails the test unless the last message holds @p part. */
void assert_said(const char *part);

/** Parses a header by nrrd_parse() and its kind, on a job that ends with the next call; without notes @p notes may be
 * NULL. */
conus_status parse_header(struct text_volume *out, void (*parse)(struct job *, struct text_volume *, struct text),
                          const struct buffer *bytes, struct notes *notes);
/** Ends that job. */
void end_header(void);

#endif
