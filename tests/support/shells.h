/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A scene of shells: bands of a volume whose values are the distance from its middle, mm. */
#ifndef CONUS_TESTS_SUPPORT_SHELLS_H
#define CONUS_TESTS_SUPPORT_SHELLS_H

#include "conus/atlas.h"

enum { SHELLS_DIM = 64, CORE = 1, MIDDLE, OUTER };

/** Core, Middle, Outer: up to 8, 14 and 20 mm. */
extern const conus_band shells[3];

/** The number of the shell of a voxel of SHELLS_DIM^3; 0 = none. */
uint32_t shell_of(const size_t at[3]);

/** An atlas of these bands alone, voxels of 1 mm around the world's origin; the caller's to destroy. */
conus_atlas *shells_atlas(void);

#endif
