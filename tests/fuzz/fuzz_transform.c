/* SPDX-License-Identifier: BSD-3-Clause */
/* Affine transforms of all programs: what is read can be inverted, and moves points to points. */
#include "base/geometry/math3.h"
#include "loaders/transform/transform_file.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    double m[16];
    double inverse[16];
    const struct bytes file = {(uint8_t *)data, size};
    if (!transform_parse(m, &file, "file.txt", NULL, NULL) &&
        !(mat4_invert_affine(inverse, m) && m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1)) {
        abort();
    }
    return 0;
}
