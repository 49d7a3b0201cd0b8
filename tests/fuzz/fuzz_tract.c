/* SPDX-License-Identifier: BSD-3-Clause */
/* Tractograms: what is accepted passes its check, and all of its numbers are there. */
#include "loaders/tracts/tract_file.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MEMORY = 1 << 22 };

/* Reads every number, so that a sanitizer sees one that is not there. */
static void read_all(const struct tractogram *t)
{
    double sum = 0;
    for (uint64_t i = 0; i < 3 * t->point_count; i++) {
        sum += fabs((double)t->points[i]);
    }
    for (size_t s = 0; s < t->scalar_count; s++) {
        uint64_t rows = t->scalars[s].per_point ? t->point_count : t->streamline_count;
        for (uint64_t i = 0; i < rows * t->scalars[s].components; i++) {
            sum += isnan(t->scalars[s].values[i]) ? 1 : 0;
        }
    }
    for (uint32_t k = 0; k < t->streamline_count; k++) {
        sum += tractogram_length(t, k);
    }
    if (!isfinite(sum)) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct tractogram tractogram = {0};
    struct notes notes = {0};
    if (!tract_file_parse(&tractogram, data, size, MEMORY, &notes)) {
        if (tractogram_check(&tractogram, &notes)) {
            abort();
        }
        read_all(&tractogram);
    }
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    return 0;
}
