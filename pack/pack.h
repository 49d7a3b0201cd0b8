/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Packs: an atlas as one block, its layout, its file, and whether it can be asked. */
#ifndef CONUS_PACK_PACK_H
#define CONUS_PACK_PACK_H

#include "atlas/atlas.h"
#include "base/status.h"
#include "conus/atlas.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The structures that a packed atlas holds as they are in memory. */

enum pack_kind {
    PACK_ATLAS,
    PACK_VOLUME,
    PACK_MESH,
    PACK_SURFACE,
    PACK_WARP,
    PACK_TRACTOGRAM,
    PACK_SCALAR,
    PACK_OBJECT,
    PACK_PLACE,
    /* In arrays. */
    PACK_STEP,
    PACK_HIDDEN_RUN,
    PACK_DISTANCES,
    PACK_NODE,
    PACK_LEAF,
    PACK_KINDS
};

size_t pack_kind_size(enum pack_kind kind);

/** Clears the pointers of a structure, and sets what says that its arrays are another's. */
void pack_make_bare(void *data, enum pack_kind kind);

/** Whether each bool of a structure that comes from elsewhere is 0 or 1, and each text in it ends. */
bool pack_flags_are_sound(const void *data, enum pack_kind kind);

/** A number that follows from the sizes of all these structures and from the sizes and places of their members: blocks
 * with another one are for another build. */
uint64_t pack_layout(void);

/* A packed atlas that is given part by part. */

/** Takes the next bytes of a block. */
typedef conus_status pack_sink(void *user, const void *data, size_t size);

/** Gives what conus_atlas_pack() packs to @p sink, from the first byte to the last, array by array. Of the large arrays
 * only a distance map that the atlas does not have yet is in memory twice. CONUS_ERROR_MEMORY, and what the sink says.
 */
conus_status atlas_pack_give(const conus_atlas *atlas, pack_sink *sink, void *user);

/** conus_atlas_attach() to bytes whose checksum holds: it reads nothing large, and asks of no streamline whether it
 * leads out of its arrays. */
conus_status atlas_attach_verified(conus_atlas **out, const void *memory, size_t size);

/* Whether an atlas that comes from elsewhere can be asked. */

/** CONUS_ERROR_DATA, with the place, where a number of an attached atlas leads out of its arrays, or is none that a
 * reader lets pass. What the numbers mean cannot be checked. */
conus_status pack_check_atlas(const conus_atlas *atlas);

/* Packs: an atlas in a file that is mapped (docs/formats.md). */

enum {
    PACK_FORMAT = 1,  /**< Raised with each change of the file or of a packed structure, which pack_layout() shows. */
    PACK_READERS = 1, /**< Raised with each change of what a reader makes of a file: older packs warn. */
    PACK_PAGE = 4096, /**< Bytes of the head. */
    PACK_CHUNK = 16 << 20
};

/** Bytes of a part. */
struct pack_part {
    uint64_t at, size;
};

/** The first page; little-endian. */
struct pack_head {
    char magic[16];
    uint32_t format, byte_order;
    uint64_t layout, size;
    struct pack_part words; /**< A text with its NUL. */
    struct pack_part sources, atlas;
    struct pack_part sums; /**< The last part: CRC-32 of each PACK_CHUNK bytes between the head and it. */
    uint8_t sha256[32];    /**< Of all behind the head. */
    uint32_t sums_crc;     /**< CRC-32 of the sums. */
    uint32_t readers;
    char version[32]; /**< For people. */
    uint8_t rest[PACK_PAGE - 180];
    uint32_t crc; /**< Of all before it. */
};

/** Whether a path is that of a pack: by its ending. */
bool pack_is(const char *path);

/** conus_atlas_load() of a pack. Reads all of it once, and checks what must be so that no question leads out of it. */
conus_status pack_load(conus_atlas **out, const char *path, const conus_load_options *options);

#endif
