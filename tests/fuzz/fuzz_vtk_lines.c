/* SPDX-License-Identifier: BSD-3-Clause */
/* Polylines in VTK's formats. */
#include "fuzz_tractogram.h"

#include "loaders/tracts/tract_formats.h"

enum { LIMIT = 1 << 22 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {.max_memory = LIMIT};
    struct tract_build build = {.job = &job, .max_memory = LIMIT};
    struct tractogram *tractogram = &build.tractogram;
    struct notes notes = {0};
    struct source *source = source_of_memory(&job, NULL, (struct text){(const char *)data, size});
    if (source) {
        vtk_lines_read(&job, source, &build);
    }
    if (!job_close(&job, &notes, NULL)) {
        tractogram->radius = TRACT_RADIUS;
        if (!tractogram_check(tractogram, &notes)) {
            fuzz_tractogram_read(tractogram);
        }
    }
    tractogram_finish(tractogram);
    notes_finish(&notes);
    return 0;
}
