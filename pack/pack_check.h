/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether an atlas that comes from elsewhere can be asked. */
#ifndef CONUS_PACK_PACK_CHECK_H
#define CONUS_PACK_PACK_CHECK_H

#include "base/status.h"
#include "conus/atlas.h"

/** Whether @p check holds for all of @p count things at @p user; threads take parts of them, of @p least or more. */
typedef bool pack_part_check(const void *user, size_t from, size_t to);
bool pack_check_parts(pack_part_check *check, const void *user, size_t count, size_t least);

/** CONUS_ERROR_DATA, with the place, where a number of an attached atlas leads out of its arrays, or is none that a
 * reader lets pass. What the numbers mean cannot be checked. */
conus_status pack_check_atlas(const conus_atlas *atlas);

#endif
