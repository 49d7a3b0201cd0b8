/* SPDX-License-Identifier: BSD-3-Clause */
/* A damaged packed atlas: attaching it fails, or gives an atlas that can be measured and destroyed. The input is the
 * damage, so that it fits every version's layout: how much is cut off the end (two bytes), whether the checksum is
 * corrected (one), then places (two bytes) and their new values (one). */
#include "conus/own.h"
#include "tests/support/packed_atlas.h"

#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { LINE = 64, CRC_AT = 24, LAYOUT_AT = 32, SMALL_END_AT = 40, HEAD = 56, PIECE = 3 };

static size_t two_bytes(const uint8_t *data)
{
    return data[0] | (size_t)data[1] << 8;
}

static void fit_checksum(uint8_t *memory, size_t size)
{
    uint64_t small_end;
    memcpy(&small_end, memory + SMALL_END_AT, sizeof small_end);
    if (size >= HEAD && small_end >= HEAD && small_end <= size) {
        uint64_t crc = crc32_z(0, memory + LAYOUT_AT, small_end - LAYOUT_AT);
        memcpy(memory + CRC_AT, &crc, sizeof crc);
    }
}

static void attach(const uint8_t *memory, size_t size)
{
    conus_atlas *atlas = NULL;
    if (!conus_atlas_attach(&atlas, memory, size)) {
        if (conus_atlas_packed_size(atlas) < HEAD) {
            abort();
        }
        conus_atlas_destroy(atlas);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < PIECE) {
        return 0;
    }
    conus_atlas *atlas = make_atlas();
    size_t packed = conus_atlas_packed_size(atlas);
    uint8_t *memory = aligned_alloc(LINE, (packed + LINE - 1) / LINE * LINE);
    must(memory ? conus_atlas_pack(memory, packed, atlas) : CONUS_ERROR_MEMORY);
    for (const uint8_t *at = data + PIECE; at + PIECE <= data + size; at += PIECE) {
        memory[two_bytes(at) % packed] = at[2];
    }
    size_t left = packed - two_bytes(data) % packed;
    if (data[2] & 1) {
        fit_checksum(memory, left);
    }
    attach(memory, left);
    free(memory);
    conus_atlas_destroy(atlas);
    return 0;
}
