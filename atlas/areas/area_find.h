/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas by what people call them. */
#ifndef CONUS_ATLAS_AREAS_AREA_FIND_H
#define CONUS_ATLAS_AREAS_AREA_FIND_H

#include "atlas/atlas.h"
#include "base/name_set.h"
#include "base/text.h"

/** The names of all objects of an atlas, to find many of them: each of the functions below looks at all objects. */
struct object_index {
    struct name_set names; /* value: the number of the object, 0 of several */
    char *digits;          /* labels as text */
};

/** Begins as all 0. The atlas must not change meanwhile. */
conus_status object_index_init(struct object_index *out, const conus_atlas *atlas);
void object_index_finish(struct object_index *index);

/** The number of the one object that goes by exactly @p text; 0 where the functions below know more: of several, of
 * none, and of one in other letters or cut in two. */
uint32_t object_index_find(const struct object_index *index, struct text text);

/** The number of the one area whose name, abbreviation or label is @p text (not empty); if there is none, whose name or
 * abbreviation differs from it in upper and lower case only. CONUS_ERROR_ARGUMENT if there is none, with the closest
 * one in the message, or if there are several, with their labels, and if it is a pathway's name. Areas that are
 * reported as their pair do not count; the message then names that, or the halves of an area that was cut in two. */
conus_status area_find(uint32_t *out, const conus_atlas *atlas, struct text text);

/** The number of the one pathway called @p text (not empty) or else, as area_find() has it, of the one area. */
conus_status object_find(uint32_t *out, const conus_atlas *atlas, struct text text);

/** The halves of the one area that was called @p text before it was cut in two; false if there is none. */
bool area_find_halves(uint32_t out[2], const conus_atlas *atlas, struct text text);

#endif
