/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A packed atlas that is given part by part. */
#ifndef CONUS_PACK_ATLAS_PACK_H
#define CONUS_PACK_ATLAS_PACK_H

#include "atlas/atlas.h"

/** Takes the next bytes of a block. */
typedef conus_status pack_sink(void *user, const void *data, size_t size);

/** Gives what conus_atlas_pack() packs to @p sink, from the first byte to the last, array by array. Of the large arrays
 * only a distance map that the atlas does not have yet is in memory twice. CONUS_ERROR_MEMORY, and what the sink says.
 */
conus_status atlas_pack_give(const conus_atlas *atlas, bool is_lean, pack_sink *sink, void *user);

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
