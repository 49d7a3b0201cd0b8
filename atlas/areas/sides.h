/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a name says about the hemisphere of its area: Precentral_L, Left-Thalamus, ctx-rh-insula. */
#ifndef CONUS_ATLAS_AREAS_SIDES_H
#define CONUS_ATLAS_AREAS_SIDES_H

#include "base/buffer.h"
#include "base/text.h"

/** A word of a name for the side: L, R, left, right, lh, rh with one case throughout (left and right also with a
 * capital), or l, r at the name's beginning or end. A word is what stands between other characters than letters and
 * digits. */
struct side_word {
    size_t start, size;
    char side;            /**< 'L' or 'R' */
    const char *opposite; /**< The word of the other side. */
};

/** Finds the first such word of @p name that starts at @p from or later. */
bool side_word_find(struct side_word *out, struct text name, size_t from);

/** Whether it is more than one letter, so that it hardly means anything else. */
bool side_word_is_long(const struct side_word *word);

/** Appends @p name with the word's opposite in its place. */
void side_word_swap(struct buffer *out, struct text name, const struct side_word *word);

/** Appends @p name without the word, its brackets and what joins it to the rest: "Precentral", "Thalamus",
 * "ctx-insula". May append nothing. */
void side_word_drop(struct buffer *out, struct text name, const struct side_word *word);

#endif
