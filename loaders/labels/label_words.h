/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The words of a file's name that say which atlas it is. */
#ifndef CONUS_LOADERS_LABELS_LABEL_WORDS_H
#define CONUS_LOADERS_LABELS_LABEL_WORDS_H

#include "base/text.h"

enum { LABEL_WORDS = 24 };

/** Words inside a name that someone else owns; a longer name has `overflow`, and can be compared with none. */
struct label_words {
    struct text items[LABEL_WORDS];
    size_t count;
    bool overflow;
};

/** The words of @p stem, a name without ending. It is cut at everything but letters and digits, between letters and
 * digits, and before a capital behind a small letter. Left out are words that any table or volume may have ("atlas",
 * "labels", "dseg"), sides ("lh"), sizes ("2mm") and BIDS's entities space-, res-, den- and tpl-. */
void label_words_find(struct label_words *out, struct text stem);

/** Whether @p all has every word of @p part; upper and lower case are the same. False of overflow. */
bool label_words_contain(const struct label_words *all, const struct label_words *part);

/** Whether both have the same words. */
bool label_words_equal(const struct label_words *a, const struct label_words *b);

#endif
