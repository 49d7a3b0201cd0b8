/* SPDX-License-Identifier: BSD-3-Clause */
/* AFNI's headers. The same bytes serve as voxels. */
#include "fuzz_text_volume.h"

#include "loaders/formats/signatures.h"
#include "loaders/volumes/text/text_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (afni_is(data, size)) {
        fuzz_text_file(data, size);
    }
    return 0;
}
