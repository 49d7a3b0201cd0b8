/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas of an atlas: by name, in lists, by side, and rolled up the area tree. */
#ifndef CONUS_ATLAS_AREAS_AREAS_H
#define CONUS_ATLAS_AREAS_AREAS_H

#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/status.h"
#include "base/text.h"
#include "conus/atlas.h"

/* Finds areas by name, abbreviation or label. */

/** The names of all objects of an atlas, to find many of them: each of the functions below looks at all objects. */
struct object_index {
    struct name_set names; /* value: the number of the object, 0 of several */
    char *digits;          /* labels as text */
};

/** Begins as all 0. The atlas must not change meanwhile. */
conus_status object_index_init(struct object_index *out, const conus_atlas *atlas);
void object_index_finish(struct object_index *index);

/** The number of the one object with exactly this name. 0 if none or several have it, or if only the functions below
 * find it (another case, an area cut in two). */
uint32_t object_index_find(const struct object_index *index, struct text text);

/** The number of the one area whose name, abbreviation or label is @p text (not empty), or else differs from it in case
 * only, or else has the same words: blanks, _, -, dots, commas and brackets are one between them, and left, right, L,
 * R, lh or rh before or behind them is the side that a word of the name, or its table, says ("left hippocampus" is
 * Hippocampus_L). CONUS_ERROR_ARGUMENT if there is none, with up to three close ones in the message; if there are
 * several, also those of both sides where the text says none, with up to 12 of their names; and if it is a pathway's
 * name. Areas that are reported as a pair do not count; the message then names the pair, or the halves of an area that
 * was cut in two. */
conus_status area_find(uint32_t *out, const conus_atlas *atlas, struct text text);

/** The number of the one pathway called @p text (not empty), or else of the one area, as by area_find(). */
conus_status object_find(uint32_t *out, const conus_atlas *atlas, struct text text);

/** The number of the one object that has @p text among the words of its name, in any case; *out is 0 if none has.
 * CONUS_ERROR_ARGUMENT if several have, with up to 12 of their names. */
conus_status object_find_word(uint32_t *out, const conus_atlas *atlas, struct text text);

/** The halves of the area that was called @p text before it was cut in two; false if there is none. */
bool area_find_halves(uint32_t out[2], const conus_atlas *atlas, struct text text);

/* Lists of areas as people write them: names, abbreviations or labels, separated by commas. */

/** Takes the next entry of a list, which is not empty. */
typedef conus_status (*area_list_take)(void *user, struct text name);

/** Receives each file that a list names, before its entries. */
typedef conus_status (*area_list_file)(void *user, const char *path, const struct bytes *content);

/** Passes each entry of @p list to @p take, up to the first that it refuses. A name with a comma stands in double
 * quotes; @FILE stands for the entries of a file, one per line, in which "#" begins a comment. @p file may be NULL. */
conus_status area_list_read(struct text list, area_list_take take, area_list_file file, void *user);

/* Left and right: what names such as Precentral_L, Left-Thalamus or ctx-rh-insula say, and which areas pair. */

/** A word of a name for the side: L, R, left, right, lh, rh in one case throughout (left and right also with a
 * capital), or l, r at the name's beginning or end. Words are runs of letters and digits. */
struct side_word {
    size_t start, size;
    char side;            /**< 'L' or 'R' */
    const char *opposite; /**< The word of the other side. */
};

/** Finds the first such word of @p name that starts at @p from or later. */
bool side_word_find(struct side_word *out, struct text name, size_t from);

/** Appends @p name with the word's opposite in its place. */
void side_word_swap(struct buffer *out, struct text name, const struct side_word *word);

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

/* Levels: the objects as which those of an atlas are reported, by rolling areas up the area tree (Eq. 10). */

struct level;

/** Makes the level that @p spec describes: a whole number N, or a list of areas.
 *
 * N is a depth in the area tree, whose roots have depth 1: areas deeper than N are reported as their ancestor at depth
 * N, others as themselves. A list has areas by name, abbreviation or label, separated by commas: an area is reported as
 * the nearest one on the list among itself and its ancestors, as itself if there is none. A name with a comma stands in
 * double quotes, and a quoted number is a label even if it stands alone. An item @FILE stands for the lines of that
 * file: one area each, never quoted; empty lines and those that begin with # do not count. Names match to the letter,
 * or else in upper or lower case where that leaves one area. An area that was cut in two stands for both halves.
 *
 * NULL reports every object as itself. Where hemispheres are merged (atlas/areas/hemispheres.c), that is after both
 * areas of a pair became their common one, whose depth both have. Pathways are always themselves. Errors:
 * CONUS_ERROR_ARGUMENT without a tree, beyond its depth, and for items that are no area or several; CONUS_ERROR_IO for
 * the file. */
conus_status level_create(struct level **out, const conus_atlas *atlas, const char *spec);

/** NULL is fine. */
void level_destroy(struct level *level);

/** [object_count + 1] the object as which each is reported; 0 for 0. NULL without a level. */
const uint32_t *level_group(const struct level *level);

/** The areas of a level that is a list, by number; @p count is 0 for another level. For records of the question, since
 * a file of areas may change. */
const uint32_t *level_areas(const struct level *level, size_t *count);

/** Whether every object is reported as itself, as without a level. */
bool level_is_identity(const struct level *level);

#endif
