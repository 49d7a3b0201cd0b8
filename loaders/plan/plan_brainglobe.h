/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas of a manifest that are the structures of a BrainGlobe folder. */
#ifndef CONUS_LOADERS_PLAN_PLAN_BRAINGLOBE_H
#define CONUS_LOADERS_PLAN_PLAN_BRAINGLOBE_H

#include "loaders/manifest/manifest.h"
#include "loaders/plan/area_plan.h"

enum { BRAINGLOBE_ORIENTATION = 9 }; /**< Bytes of an orientation, cut off if it is longer than any can be. */

/** Puts the text "orientation" of the object @p text, a metadata.json, into @p out, which stays as it is without one.
 * Damaged JSON, or an orientation that is no text, is CONUS_ERROR_DATA: surfaces would lie anywhere. */
conus_status brainglobe_metadata_parse(char out[BRAINGLOBE_ORIENTATION], struct text text);

/** Plans "brainglobe". @p path is the manifest's, areas[entry] the entry. */
conus_status plan_brainglobe(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                             struct notes *notes);

#endif
