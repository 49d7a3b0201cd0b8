/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-hdf5's stream of a MINC volume: it has as many voxels as its header says. */
#include "base/memory.h"
#include "loaders/volumes/minc.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static conus_status count(void *user, const uint8_t *data, size_t size)
{
    size_t *counted = user;
    volatile uint8_t last = size ? data[size - 1] : 0;
    (void)last;
    *counted += size;
    return CONUS_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct hdf5 *hdf5 = NULL;
    struct minc minc = {0};
    struct volume_header header;
    struct bytes stream = {memory_copy(data, size, 1), size};
    conus_status status = stream.data ? hdf5_parse(&hdf5, &stream) : CONUS_ERROR_MEMORY;
    status = status ? status : minc_from_hdf5(&minc, &header, hdf5);
    if (!status) {
        size_t counted = 0;
        status = minc_read(&minc, count, &counted);
        if (status || counted != header.volume_size || header.info.volume_count != 1) {
            abort();
        }
    }
    minc_finish(&minc);
    return 0;
}
