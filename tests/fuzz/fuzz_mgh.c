/* SPDX-License-Identifier: BSD-3-Clause */
/* MGH headers and voxels. */
#include "fuzz_volume.h"

#include "loaders/volumes/mgh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct volume_header header;
    struct notes notes = {0};
    if (!mgh_header_parse(&header, data, size, &notes)) {
        fuzz_check_header(&header);
        fuzz_decode(&header, data, size);
    }
    notes_finish(&notes);
    return 0;
}
