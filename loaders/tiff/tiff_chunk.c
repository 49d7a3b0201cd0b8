/* SPDX-License-Identifier: BSD-3-Clause */
/* Unpacks a strip or tile in one go into exactly the bytes that it has to have. */
#include "loaders/tiff/tiff_chunk.h"

#include "base/byte_order.h"
#include "base/memory.h"
#include "loaders/tiff/tiff_lzw.h"

#include <libdeflate.h>
#include <string.h>

void tiff_unpacker_finish(struct tiff_unpacker *unpacker)
{
    libdeflate_free_decompressor(unpacker->deflate);
    memory_free(unpacker->lzw);
    *unpacker = (struct tiff_unpacker){0};
}

static conus_status unpack_deflate(struct tiff_unpacker *unpacker, const struct tiff_chunk *chunk, size_t size)
{
    unpacker->deflate = unpacker->deflate ? unpacker->deflate : libdeflate_alloc_decompressor();
    if (!unpacker->deflate) {
        return fail(CONUS_ERROR_MEMORY, "not enough memory to unpack");
    }
    size_t got = 0;
    enum libdeflate_result result =
        libdeflate_zlib_decompress(unpacker->deflate, chunk->packed, chunk->packed_size, chunk->out, size, &got);
    return result == LIBDEFLATE_SUCCESS && got == size ? CONUS_OK : CONUS_ERROR_DATA;
}

static conus_status unpack_lzw(struct tiff_unpacker *unpacker, const struct tiff_chunk *chunk, size_t size)
{
    unpacker->lzw = unpacker->lzw ? unpacker->lzw : memory_raw(1, sizeof *unpacker->lzw);
    if (!unpacker->lzw) {
        return CONUS_ERROR_MEMORY;
    }
    return tiff_lzw_unpack(chunk->out, size, chunk->packed, chunk->packed_size, unpacker->lzw) ? CONUS_OK
                                                                                               : CONUS_ERROR_DATA;
}

/* Defines how the pixels of one size in a row become sums of all up to each. */
#define DEFINE_SUMS(name, type, read, swap)                                                                            \
    static void name(uint8_t *row, size_t count, bool swapped)                                                         \
    {                                                                                                                  \
        type sum = 0;                                                                                                  \
        for (size_t i = 0; i < count; i++) {                                                                           \
            sum = (type)(sum + read(row + i * sizeof sum, swapped));                                                   \
            type stored = swapped ? swap(sum) : sum;                                                                   \
            memcpy(row + i * sizeof sum, &stored, sizeof stored);                                                      \
        }                                                                                                              \
    }

static uint8_t read_byte(const uint8_t *data, bool swapped)
{
    (void)swapped;
    return *data;
}

DEFINE_SUMS(sum_8, uint8_t, read_byte, (uint8_t))
DEFINE_SUMS(sum_16, uint16_t, order_u16, __builtin_bswap16)
DEFINE_SUMS(sum_32, uint32_t, order_u32, __builtin_bswap32)
DEFINE_SUMS(sum_64, uint64_t, order_u64, __builtin_bswap64)

static void undo_differences(const struct tiff_page *page, const struct tiff_chunk *chunk, bool swapped)
{
    size_t row_bytes = chunk->width * (page->bits / 8);
    void (*sum)(uint8_t *, size_t, bool) = page->bits == 8    ? sum_8
                                           : page->bits == 16 ? sum_16
                                           : page->bits == 32 ? sum_32
                                                              : sum_64;
    for (uint64_t row = 0; row < chunk->rows; row++) {
        sum(chunk->out + row * row_bytes, chunk->width, swapped);
    }
}

conus_status tiff_chunk_unpack(struct tiff_unpacker *unpacker, const struct tiff_page *page,
                               const struct tiff_chunk *chunk, bool swapped)
{
    size_t size = chunk->width * chunk->rows * (page->bits / 8);
    conus_status status = CONUS_OK;
    if (page->compression == TIFF_PLAIN) {
        memcpy(chunk->out, chunk->packed, size); /* as many are there: checked with the directory */
    } else {
        status =
            page->compression == TIFF_LZW ? unpack_lzw(unpacker, chunk, size) : unpack_deflate(unpacker, chunk, size);
    }
    if (!status && page->differences) {
        undo_differences(page, chunk, swapped);
    }
    return status;
}
