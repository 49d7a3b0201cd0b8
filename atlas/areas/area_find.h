/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Finds areas by name, abbreviation or label. */
#ifndef CONUS_ATLAS_AREAS_AREA_FIND_H
#define CONUS_ATLAS_AREAS_AREA_FIND_H

#include "atlas/atlas.h"
#include "base/name_set.h"
#include "base/text.h"
#include "conus/atlas.h"

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

#endif
