/* SPDX-License-Identifier: BSD-3-Clause */
/* Polylines in VTK's formats. */
#include "fuzz_tractogram.h"

#include "loaders/tracts/tract_formats.h"

enum { LIMIT = 1 << 22 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct tractogram tractogram = {0};
    struct notes notes = {0};
    const struct bytes bytes = {(uint8_t *)data, size};
    if (!vtk_lines_parse(&tractogram, &bytes, LIMIT, &notes)) {
        tractogram.radius = TRACT_RADIUS;
        if (!tractogram_check(&tractogram, &notes)) {
            fuzz_tractogram_read(&tractogram);
        }
    }
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    return 0;
}
