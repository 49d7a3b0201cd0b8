/* SPDX-License-Identifier: BSD-3-Clause */
/* Tractograms: an accepted one passes its check, and all of its numbers can be read. */
#include "fuzz_tractogram.h"

#include "loaders/tracts/tracts.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MEMORY = 1 << 22 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct tractogram tractogram = {0};
    struct notes notes = {0};
    struct job job = {.max_memory = MEMORY};
    tract_file_parse(&job, &tractogram, (struct text){(const char *)data, size});
    if (!job_close(&job, &notes, NULL)) {
        if (tractogram_check(&tractogram, &notes)) {
            abort();
        }
        fuzz_tractogram_read(&tractogram);
    }
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    return 0;
}
