/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options that take a place: numbers, an area, a position of a cap (conus/pose.h). */
#ifndef CONUS_SETTINGS_NAMED_PLACES_H
#define CONUS_SETTINGS_NAMED_PLACES_H

#include "conus/report.h"

#include <stdbool.h>
#include <stddef.h>

/** The places of one run. Those that are more than three plain numbers are kept, for the head of the answer. */
struct named_places {
    const conus_atlas *atlas; /* in which they are */
    const conus_frame *frame; /* space and unit of their numbers */
    conus_named_place *items; /* [count] */
    size_t count;
    bool has_axis; /* one has two ends */
};

void named_places_finish(struct named_places *places);

/** Finds the point that @p text, the value of the option @p option, means, world mm; @p other as of
 * conus_place_options. Returns the exit code and prints an error unless it is 0. */
int named_places_find(double out[3], struct named_places *places, const char *option, const char *text,
                      const double *other);

/** Finds both ends of an axis, one of which may be near:AREA. Likewise. */
int named_places_find_ends(double origin[3], double toward[3], struct named_places *places,
                           const char *const options[2], const char *const texts[2]);

/** Keeps how @p text, of the option @p option, was understood: as @p place, or else a sentence. Likewise. */
int named_places_add(struct named_places *places, const char *option, const char *text, const conus_place *place);

/** Says each of those that are kept, a note a line, but what is about the whole question. */
void named_places_say(const struct named_places *places);

#endif
