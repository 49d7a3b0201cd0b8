/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Bands of values that are to become pathways: what they may be. */
#ifndef CONUS_LOADERS_SCENE_BANDS_H
#define CONUS_LOADERS_SCENE_BANDS_H

#include "atlas/atlas.h"

/** Most bands of one volume. */
enum { BAND_LIMIT = 4096 };

/** Whether @p bands can be pathways of the volume @p info, whose minimum and maximum are known, in @p atlas: each has a
 * name of its own and holds some of the range of values, and none overlap. CONUS_ERROR_ARGUMENT with the file. */
conus_status bands_check(const conus_band *bands, size_t count, const conus_volume_info *info,
                         const conus_atlas *atlas);

/** Notes what looks wrong with bands that have just become the last pathways of @p atlas: those without voxels, and
 * those that end at the largest value, so that no band has it. */
conus_status bands_note(struct notes *notes, const conus_atlas *atlas, size_t count);

#endif
