/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Packs: an atlas in a file that is mapped (docs/formats.md). */
#ifndef CONUS_PACK_PACK_FILE_H
#define CONUS_PACK_PACK_FILE_H

#include "conus/atlas.h"

#include <stdbool.h>

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
