/* SPDX-License-Identifier: BSD-3-Clause */
/* NRRD headers, segments and voxels. */
#include "fuzz_text_volume.h"

#include "loaders/volumes/text/text_volume.h"
#include "sources/signatures.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (nrrd_is(data, size)) {
        fuzz_text_file(data, size, FORMAT_NRRD);
    }
    return 0;
}
