/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Compares the box of something beside the areas with that of the areas. */
#ifndef CONUS_ATLAS_FIT_BOX_FIT_H
#define CONUS_ATLAS_FIT_BOX_FIT_H

#include "atlas/atlas.h"
#include "base/geometry/box3.h"

/** The box, world mm, around the areas of @p atlas, of its volumes, of its surfaces or of both; empty without any. */
struct box3 fit_box_of_areas(const conus_atlas *atlas, bool volumes, bool surfaces);

/** Adds a warning to @p notes if the longest side of @p box is 250 times that of @p areas or more, or a 250th or less:
 * then one of the two is in micrometres or metres, since no brain is so much larger than an area. @p words say what is
 * in the box, "bundle AF". *@p said tells whether there is a warning; none if a box is empty. CONUS_ERROR_MEMORY. */
conus_status fit_note_size(bool *said, struct notes *notes, const char *words, const struct box3 *box,
                           const struct box3 *areas);

/** The same for a context of @p atlas; and a warning if its box does not touch that of the areas: it is
 * in another space. For an atlas that was moved fit_note() says that. */
conus_status fit_note_context(struct notes *notes, const conus_atlas *atlas, const char *words, const struct box3 *box);

#endif
