/* SPDX-License-Identifier: BSD-3-Clause */
/* Composites and X5 in conus-hdf5's stream: an accepted field has finite numbers. */
#include "base/memory.h"
#include "loaders/transform/transform_chain.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static conus_status parse(struct transform_chain *chain, const struct hdf5 *hdf5)
{
    enum { MOST = 1 << 20 };
    struct buffer words = {0};
    conus_status status = (x5_is(hdf5) ? x5_parse : itk_hdf5_parse)(chain, hdf5, MOST, &words);
    buffer_finish(&words);
    return status ? status : chain_end(chain);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct hdf5 *hdf5 = NULL;
    struct transform_chain chain;
    struct bytes stream = {memory_copy(data, size, 1), size};
    chain_begin(&chain);
    conus_status status = stream.data ? hdf5_parse(&hdf5, &stream) : CONUS_ERROR_MEMORY;
    status = status ? status : parse(&chain, hdf5);
    for (size_t i = 0; !status && i < chain.count; i++) {
        const size_t *dim = chain.fields[i].dim;
        for (size_t n = 0; n < 3 * dim[0] * dim[1] * dim[2]; n++) {
            if (!isfinite(chain.fields[i].vectors[n])) {
                abort();
            }
        }
    }
    transform_chain_finish(&chain);
    hdf5_destroy(hdf5);
    return status == CONUS_OK || *conus_message() ? 0 : -1;
}
