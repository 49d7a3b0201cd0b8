/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-hdf5's stream of a MINC volume: it has as many voxels as its header says. */
#include "base/memory.h"
#include "loaders/volumes/parts.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void count(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count)
{
    size_t *counted = user;
    volatile uint8_t last = count ? voxels[count - 1] : 0;
    (void)last;
    if (first != *counted || !job_ok(job)) {
        abort();
    }
    *counted += count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    struct volume_input v = {.header.info.slope = 1};
    const struct text stream = {job_adopt(&job, memory_copy(data, size, 1)), size};
    if (stream.data) {
        minc_from_hdf5(&job, &v, hdf5_of_stream(&job, stream));
    }
    if (stream.data && job_ok(&job)) {
        size_t counted = 0;
        v.read(&job, &v, 0, 1, &(struct voxel_sink){count, &counted});
        if (!job_ok(&job) || counted * volume_datatype_size(v.header.datatype) != v.header.volume_size ||
            v.header.info.volume_count != 1) {
            abort();
        }
    }
    job_end(&job);
    return 0;
}
