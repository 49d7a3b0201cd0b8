/* SPDX-License-Identifier: BSD-3-Clause */
/* NRRD headers, segments and voxels. */
#include "fuzz_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_volume(data, size, FORMAT_NRRD);
    return 0;
}
