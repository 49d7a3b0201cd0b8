/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Names for the numbers in an image: the value of OpenEXR's attribute `idManifest`, which its C library cannot encode.
 * Byte for byte what CompressedIDManifest of OpenEXR 3.1 gives:
 *
 *     u64 size, then a zlib stream of that many bytes:
 *     i32 0                                            version
 *     strings: all texts, each once, sorted; each but the first as how many bytes it shares with the one before
 *              (u8; u16 big-endian if that one is longer than 255), then the rest
 *     i32 n, n x (i32 first, i32 last)                 ranks: texts in the order of these runs, skipping those that had
 *                                                      their turn; frequent ones come early, as small numbers
 *     i32 groups, each:
 *         strings channels, strings components, u8 lifetime, pascal hash scheme, pascal encoding scheme,
 *         u8 storage of differences between ids: 1 as u32, 2 as varint; i32 entries,
 *         each the difference to the id before, and a varint rank per component
 *
 *     strings = i32 count, varint lengths, bytes;  pascal = u32 length, bytes;  varint = 7 bits a byte, lowest first.
 *
 * All little-endian. */
#ifndef CONUS_RENDER_IMAGE_ID_MANIFEST_H
#define CONUS_RENDER_IMAGE_ID_MANIFEST_H

#include "base/files/file.h"
#include "base/status.h"

/** The names of the ids in one channel. Ids are stable (the same in all images of the same atlas), not hashes. */
struct id_manifest_group {
    const char *channel;
    const char *const *components; /**< The components of each name: "name", "label". */
    size_t component_count;
    const uint32_t *ids; /**< [count], ascending, each once. */
    size_t count;
    const char *const *texts; /**< [count * component_count], UTF-8. */
};

/** @p out is the caller's to finish. CONUS_ERROR_UNSUPPORTED where it all is larger than 1 GiB. */
conus_status id_manifest_format(struct bytes *out, const struct id_manifest_group *groups, size_t group_count);

#endif
