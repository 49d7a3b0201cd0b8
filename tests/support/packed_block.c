/* SPDX-License-Identifier: BSD-3-Clause */
/* Packs an atlas into pages, and attaches it. */
#include "packed_block.h"

#include "conus/own.h"
#include "test.h"

#include <sys/mman.h>

struct block block_pack(const conus_atlas *atlas)
{
    struct block block = {.size = conus_atlas_packed_size(atlas)};
    block.memory = mmap(NULL, block.size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_ptr_not_equal(block.memory, MAP_FAILED);
    assert_ok(conus_atlas_pack(block.memory, block.size, atlas));
    return block;
}

conus_atlas *block_attach(const struct block *block)
{
    conus_atlas *attached = NULL;
    assert_ok(conus_atlas_attach(&attached, block->memory, block->size));
    return attached;
}

void block_drop(struct block block)
{
    munmap(block.memory, block.size);
}
