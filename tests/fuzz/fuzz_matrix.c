/* SPDX-License-Identifier: BSD-3-Clause */
/* The matrices of a tracker: an accepted one is a rigid pose, a refused one has its reason. */
#include "base/geometry/math3.h"
#include "poses/pose_stream.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const conus_pose_options options = {.format = "matrix"};
    const struct text text = {size ? (const char *)data : "", size}; /* libFuzzer's nothing is NULL */
    conus_pose_list *list = NULL;
    if (pose_list_parse(&list, text, &options)) {
        return 0;
    }
    const conus_pose_row *row = conus_pose_list_row(list, 0);
    if (!row || conus_pose_list_count(list) != 1) {
        abort();
    }
    const double *m = row->pose.world_from_device;
    for (int a = 0; a < 3 && !row->error; a++) {
        for (int b = 0; b < 3; b++) {
            double product = m[4 * a] * m[4 * b] + m[4 * a + 1] * m[4 * b + 1] + m[4 * a + 2] * m[4 * b + 2];
            if (!(fabs(product - (a == b)) < 1e-6 && isfinite(m[12 + a]))) {
                abort();
            }
        }
    }
    if (!row->error && !(fabs(mat4_determinant3(m) - 1) < 1e-6)) {
        abort();
    }
    conus_pose_list_destroy(list);
    return 0;
}
