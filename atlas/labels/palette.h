/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Colours for areas to which no table gives one. */
#ifndef CONUS_ATLAS_PALETTE_H
#define CONUS_ATLAS_PALETTE_H

#include <stddef.h>
#include <stdint.h>

/** The @p index-th of an endless row of sRGB colours in which neighbours differ: hues a golden angle apart, with
 * three lightnesses in turn. */
void palette_colour(uint8_t rgb[3], size_t index);

/** The same of a palette that people with any colour vision tell apart as well as can be: the eight colours of Okabe
 * and Ito
 * ("Color Universal Design", 2008) but for black, each plain, lighter and darker: neighbours in the list differ in
 * lightness, too. */
void palette_safe_colour(uint8_t rgb[3], size_t index);

#endif
