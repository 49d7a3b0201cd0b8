/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The structures that a packed atlas holds as they are in memory. */
#ifndef CONUS_PACK_PACK_LAYOUT_H
#define CONUS_PACK_PACK_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

#endif
