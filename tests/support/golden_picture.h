/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Comparison with the golden pictures of tests/golden. */
#ifndef CONUS_TESTS_SUPPORT_GOLDEN_PICTURE_H
#define CONUS_TESTS_SUPPORT_GOLDEN_PICTURE_H

#include "render/image/image.h"

/** The largest change of the mean radiance of a channel in a block of an eighth by a sixth of the picture, relative to
 * the radiance in @p wanted, or to 0.05 of white where it is darker. */
double golden_brightness(const conus_image *got, const conus_image *wanted);

/** Fails unless @p got looks like tests/golden/@p name. Drivers differ in the last bits of filtering, which moves an
 * edge now and then; so 0.015 of white, rms, and a change of brightness by 1 % in any block are allowed. With
 * CONUS_WRITE_GOLDEN=1 it writes the file anew. */
void golden_check(const conus_image *got, const char *name);

#endif
