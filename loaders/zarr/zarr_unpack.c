/* SPDX-License-Identifier: BSD-3-Clause */
/* Unpacks a chunk into exactly the bytes that it must have. */
#include "base/byte_order.h"
#include "base/system/system.h"
#include "loaders/zarr/zarr.h"

#include <libdeflate.h>
#include <string.h>
#include <zstd.h>

struct zarr_unpacker {
    ZSTD_DCtx *zstd;
    struct libdeflate_decompressor *deflate;
    int (*blosc_check)(const void *data, size_t size, size_t *unpacked);
    int (*blosc_unpack)(const void *data, void *out, size_t size, int threads);
};

static void destroy(void *user)
{
    struct zarr_unpacker *unpacker = user;
    ZSTD_freeDCtx(unpacker->zstd);
    libdeflate_free_decompressor(unpacker->deflate);
}

struct zarr_unpacker *zarr_unpacker_new(struct job *job)
{
    struct zarr_unpacker *unpacker = job_new(job, struct zarr_unpacker);
    if (!unpacker) {
        return NULL;
    }
    unpacker->zstd = ZSTD_createDCtx();
    unpacker->deflate = libdeflate_alloc_decompressor();
    if (!unpacker->zstd || !unpacker->deflate) {
        job_fail(job, CONUS_ERROR_MEMORY, "no memory to unpack chunks");
    }
    job_own(job, destroy, unpacker);
    return unpacker;
}

/* The library is looked for only here: few stores need it, and linked it would slow down every start. */
static void load_blosc(struct job *job, struct zarr_unpacker *unpacker)
{
    if (!unpacker->blosc_check || !unpacker->blosc_unpack) {
        *(void **)&unpacker->blosc_check = system_function("libblosc.so.1", "blosc_cbuffer_validate");
        *(void **)&unpacker->blosc_unpack = system_function("libblosc.so.1", "blosc_decompress_ctx");
    }
    if (!unpacker->blosc_check || !unpacker->blosc_unpack) {
        job_refuse(job, "packed with blosc: libblosc.so.1 is needed (Debian: libblosc1)");
    }
}

/* Blosc's header says in byte 2 whether bytes or bits were shuffled, in byte 3 by numbers of which size; no sum guards
 * that. A program may have chosen another size than the array's, but one that numbers have. */
static void check_shuffle(struct job *job, const uint8_t *data, size_t size)
{
    enum { SHUFFLED = 1 | 4 };
    bool is_odd = size > 3 && (data[2] & SHUFFLED) && data[3] != 1 && data[3] != 2 && data[3] != 4 && data[3] != 8;
    if (is_odd) {
        job_bad(job, "blosc: shuffled by numbers of %d bytes, allowed are 1, 2, 4 and 8", data[3]);
    }
}

/* Whether it came out as `wanted` bytes. */
static bool decompress(struct job *job, uint8_t *out, struct zarr_unpacker *unpacker, enum zarr_packing packing,
                       const uint8_t *data, size_t size, size_t wanted)
{
    size_t used = 0;
    size_t got = 0;
    switch (packing) {
    case ZARR_ZSTD:
        return ZSTD_decompressDCtx(unpacker->zstd, out, wanted, data, size) == wanted;
    case ZARR_GZIP:
        return libdeflate_gzip_decompress_ex(unpacker->deflate, data, size, out, wanted, &used, &got) ==
                   LIBDEFLATE_SUCCESS &&
               used == size && got == wanted;
    case ZARR_ZLIB:
        return libdeflate_zlib_decompress_ex(unpacker->deflate, data, size, out, wanted, &used, &got) ==
                   LIBDEFLATE_SUCCESS &&
               used == size && got == wanted;
    case ZARR_BLOSC:
        check_shuffle(job, data, size);
        load_blosc(job, unpacker);
        return job_ok(job) && unpacker->blosc_check(data, size, &got) == 0 && got == wanted &&
               unpacker->blosc_unpack(data, out, wanted, 1) == (int)wanted;
    default:
        return true;
    }
}

/* RFC 3720: the polynomial 0x1edc6f41, reflected. */
static uint32_t crc32c(const uint8_t *data, size_t size)
{
    uint32_t table[256];
    uint32_t sum = ~0U;
    for (uint32_t i = 0; i < 256; i++) {
        table[i] = i;
        for (int bit = 0; bit < 8; bit++) {
            table[i] = table[i] >> 1 ^ (table[i] & 1 ? 0x82f63b78 : 0);
        }
    }
    for (size_t i = 0; i < size; i++) {
        sum = sum >> 8 ^ table[(sum ^ data[i]) & 0xff];
    }
    return ~sum;
}

void zarr_unpack(struct job *job, uint8_t *out, struct zarr_unpacker *unpacker, const struct zarr_chain *chain,
                 struct bytes stored, size_t wanted)
{
    enum { SUM = sizeof(uint32_t) };
    const uint8_t *data = stored.data;
    size_t size = stored.size;
    bool fine = job_step(job);
    for (size_t i = chain->count; fine && i-- > 0;) {
        size_t inside = wanted; /* with the sums that are still around it */
        for (size_t k = 0; k < i; k++) {
            inside += SUM;
        }
        if (chain->packings[i] == ZARR_CRC32C) {
            fine = size >= SUM && crc32c(data, size - SUM) == order_u32(data + size - SUM, !BIG_ENDIAN_IS_SWAPPED);
            size -= SUM;
        } else {
            fine = decompress(job, out, unpacker, chain->packings[i], data, size, inside);
            data = out;
            size = inside;
        }
    }
    if (!fine || size != wanted) {
        job_bad(job, "damaged, or not the %zu bytes of a chunk", wanted);
    } else if (data != out) {
        memcpy(out, data, wanted);
    }
}
