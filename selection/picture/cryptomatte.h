/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Cryptomatte 1.2.0 (J. Friedman, A. Jones, Psyop 2015): identifiers as hashes of names in float channels, which
 * compositing programs turn into a matte per area. */
#ifndef CONUS_SELECTION_PICTURE_CRYPTOMATTE_H
#define CONUS_SELECTION_PICTURE_CRYPTOMATTE_H

#include "conus/image.h"

/** Hash of a name: MurmurHash3_x86_32 with seed 0, its exponent kept away from 0 and 255, so that its bits are a normal
 * float. */
uint32_t cryptomatte_hash(const char *name);

/** Adds the layer "CryptoObject" to an image of @p selection's pixels: channels CryptoObject00.R (hash of the object
 * hit first, 0 = none), .G (coverage: 1 or 0), .B and .A (no second object), and its attributes with a manifest of the
 * objects in the image. Of objects with one name all but the first are called "NAME (LABEL)". */
conus_status cryptomatte_add(conus_image *image, const conus_selection *selection);

#endif
