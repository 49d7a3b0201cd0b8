/* SPDX-License-Identifier: BSD-3-Clause */
/** @file BrainGlobe's metadata.json, as far as it places surfaces. */
#ifndef CONUS_LOADERS_LABELS_GLOBE_METADATA_H
#define CONUS_LOADERS_LABELS_GLOBE_METADATA_H

#include "base/status.h"
#include "base/text.h"

enum { GLOBE_ORIENTATION = 9 }; /**< Bytes of an orientation, cut off if it is longer than any can be. */

/** Puts the text "orientation" of the object @p text into @p out, which stays as it is without one. Damaged JSON, or an
 * orientation that is no text, is CONUS_ERROR_DATA: surfaces would lie anywhere. */
conus_status globe_metadata_parse(char out[GLOBE_ORIENTATION], struct text text);

#endif
