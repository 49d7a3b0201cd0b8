/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How areas stand out in a picture with a cone; apart from OpenGL's structures, for cuts that need none. */
#ifndef CONUS_SELECTION_PICTURE_PICTURE_EMPHASIS_H
#define CONUS_SELECTION_PICTURE_PICTURE_EMPHASIS_H

#include "selection/selection.h"

/** How each object, by number, stands out in a picture of @p selection: [object count + 1] of enum emphasis, to be
 * freed. @p chosen (0 = none) and what is below it in the area tree are never pale. NULL without memory. */
uint8_t *picture_emphasis(const conus_selection *selection, uint32_t chosen);

#endif
