/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Colours for areas to which no table gives one. */
#ifndef CONUS_ATLAS_PALETTE_H
#define CONUS_ATLAS_PALETTE_H

#include <stddef.h>
#include <stdint.h>

/** The @p index-th of an endless row of sRGB colours in which neighbours differ: hues a golden angle apart, with
 * three lightnesses in turn. */
void palette_colour(uint8_t rgb[3], size_t index);

#endif
