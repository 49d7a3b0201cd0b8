/* SPDX-License-Identifier: BSD-3-Clause */
/* Composites and X5 in conus-hdf5's stream: an accepted field has finite numbers. */
#include "base/memory.h"
#include "loaders/transform/transform.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    enum { MOST = 1 << 20 };
    struct transform_chain chain;
    struct job job = {.max_memory = MOST};
    const char *copy = job_adopt(&job, memory_copy(data, size, 1));
    const struct hdf5 *hdf5 = hdf5_of_stream(&job, (struct text){copy, copy ? size : 0});
    chain_begin(&chain);
    (void)(x5_is(hdf5) ? x5_parse : itk_hdf5_parse)(&job, &chain, hdf5);
    chain_end(&job, &chain);
    for (size_t i = 0; job_ok(&job) && i < chain.count; i++) {
        const size_t *dim = chain.fields[i].dim;
        for (size_t n = 0; n < 3 * dim[0] * dim[1] * dim[2]; n++) {
            if (chain.fields[i].vectors && !isfinite(chain.fields[i].vectors[n])) {
                abort();
            }
        }
    }
    transform_chain_finish(&chain);
    return job_close(&job, NULL, NULL) == CONUS_OK || *conus_message() ? 0 : -1;
}
