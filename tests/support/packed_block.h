/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A packed atlas in separate pages. */
#ifndef CONUS_TESTS_SUPPORT_PACKED_BLOCK_H
#define CONUS_TESTS_SUPPORT_PACKED_BLOCK_H

#include "atlas/atlas.h"

struct block {
    uint8_t *memory; /**< Pages of mmap(): end them with block_drop(). */
    size_t size;
};

struct block block_pack(const conus_atlas *atlas);
conus_atlas *block_attach(const struct block *block); /**< To be destroyed before the block is dropped. */
void block_drop(struct block block);

#endif
