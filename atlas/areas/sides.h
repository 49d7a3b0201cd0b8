/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Left and right: what names such as Precentral_L, Left-Thalamus or ctx-rh-insula say, and which areas pair. */
#ifndef CONUS_ATLAS_AREAS_SIDES_H
#define CONUS_ATLAS_AREAS_SIDES_H

#include "atlas/atlas.h"
#include "base/buffer.h"
#include "base/text.h"
#include "conus/atlas.h"

/** A word of a name for the side: L, R, left, right, lh, rh in one case throughout (left and right also with a
 * capital), or l, r at the name's beginning or end. Words are runs of letters and digits. */
struct side_word {
    size_t start, size;
    char side;            /**< 'L' or 'R' */
    const char *opposite; /**< The word of the other side. */
};

/** Finds the first such word of @p name that starts at @p from or later. */
bool side_word_find(struct side_word *out, struct text name, size_t from);

/** Whether the word has more than one letter, so that it hardly means anything else. */
bool side_word_is_long(const struct side_word *word);

/** Appends @p name with the word's opposite in its place. */
void side_word_swap(struct buffer *out, struct text name, const struct side_word *word);

/** Appends @p name without the word, its brackets and what joins it to the rest: "Precentral", "Thalamus", "ctx-
 * insula". May append nothing. */
void side_word_drop(struct buffer *out, struct text name, const struct side_word *word);

/** Finds pairs of a left and a right area. Two are a pair if their names differ in nothing but a word for the side, or
 * are equal and the table gives L for one and R for the other; if no other area could take the place of either; if the
 * table's hemispheres do not contradict; and if they have the same parent, or their parents are a pair. @p out is
 * [area_count + 1]: for a left area the number of the right one, else 0. memory_free() it. */
conus_status hemispheres_pair(uint32_t **out, const conus_atlas *atlas);

/** Appends what the names of a left and a right area have in common: without the word for the side, or the whole name
 * if they are equal. Nothing if they differ otherwise. */
void hemispheres_common_name(struct buffer *out, const char *left, const char *right);

/** Finds the power of ten above all labels of areas, with room for three more digits; CONUS_ERROR_UNSUPPORTED if there
 * is none. */
conus_status hemispheres_label_step(uint32_t *out, const conus_atlas *atlas);

/** Finds the side of each area by itself: writes 'L', 'R', 'B' or 0, by number, to @p out of [area_count + 1], which is
 * zeroed. The side is what the table says, or that of the area in its pair (hemispheres_pair()), or else a word in its
 * name such as "left" or "rh". On failure @p out may have been written to. */
conus_status area_sides_find(char *out, const conus_atlas *atlas);

/** Warns of areas whose label table says another side than a word in their name (a lone letter counts where an area has
 * the other one), and where at least three quarters of the pairs of a left and a right area (hemispheres_pair()), and
 * three of them or more, lie the other way round: the left one at the larger mean x of voxels or vertices. The
 * midline's place does not matter. In large grids every so many-th row is read. CONUS_ERROR_MEMORY. */
conus_status conflicting_sides_note(conus_atlas *atlas);

#endif
