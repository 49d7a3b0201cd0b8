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
conus_status atlas_pack_give(const conus_atlas *atlas, pack_sink *sink, void *user);

/** conus_atlas_attach() to bytes whose checksum holds: it reads nothing large, and asks of no streamline whether it
 * leads out of its arrays. */
conus_status atlas_attach_verified(conus_atlas **out, const void *memory, size_t size);

#endif
