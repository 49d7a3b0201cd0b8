/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as the metadata of a Zarr array and of OME, and as a chunk packed in every way. */
#include "loaders/zarr/zarr.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    enum { WANTED = 96 };
    const struct text text = {(const char *)data, size};
    struct zarr_array array;
    struct ome ome;
    static struct job lasting; /* to look for libblosc each time would take longest */
    static struct zarr_unpacker *unpacker;
    unpacker = unpacker ? unpacker : zarr_unpacker_new(&lasting);
    struct job job = {0};
    zarr_array_parse(&job, &array, text);
    if (job_ok(&job)) {
        for (size_t i = 0; i < array.rank; i++) {
            if (!array.chunk[i] || array.file_chunk[i] % array.chunk[i] || array.chain.order[i] >= array.rank) {
                abort();
            }
        }
    }
    job_end(&job);
    ome_parse(&job, &ome, text);
    if (job_ok(&job) != (ome.count > 0)) {
        abort();
    }
    job_end(&job);
    for (int packing = ZARR_ZSTD; packing <= ZARR_CRC32C; packing++) {
        const struct zarr_chain chain = {.packings = {(enum zarr_packing)packing}, .count = 1};
        uint8_t out[WANTED + ZARR_AROUND];
        zarr_unpack(&job, out, unpacker, &chain, (struct bytes){(uint8_t *)data, size}, WANTED);
        job_end(&job);
    }
    return 0;
}
