/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A packed atlas in a file. */
#ifndef CONUS_SELECTION_BATCH_ATLAS_PACK_H
#define CONUS_SELECTION_BATCH_ATLAS_PACK_H

#include "atlas/atlas.h"

/** Writes what conus_atlas_pack() packs to an open file, from @p at on, array by array. Of the large arrays only two
 * are in memory twice: a distance map that the atlas does not have yet, and points that are mapped from a tractogram's
 * file. Gaps are left as they are. A lean pack leaves out points that a tractogram's file has (file_offset); whoever
 * attaches the atlas maps them. CONUS_ERROR_IO, CONUS_ERROR_MEMORY. */
conus_status atlas_pack_write(int descriptor, size_t at, const conus_atlas *atlas, bool is_lean);

/** How many bytes it writes. */
size_t atlas_pack_size(const conus_atlas *atlas, bool is_lean);

/** conus_atlas_attach() to bytes whose checksum holds: it reads nothing large, and asks of no streamline whether it
 * leads out of its arrays. */
conus_status atlas_attach_verified(conus_atlas **out, const void *memory, size_t size);

#endif
