/* SPDX-License-Identifier: BSD-3-Clause */
/* A pose that is read without error is rigid. */
#include "base/math3.h"
#include "selection/pose_list.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    conus_pose_list *list = NULL;
    if (pose_list_parse(&list, (struct text){(const char *)data, size},
                        &(conus_pose_options){.space = size % 2 ? CONUS_LPS : CONUS_RAS})) {
        return 0;
    }
    for (size_t i = 0; i < conus_pose_list_count(list); i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i);
        if (!row->error && !(fabs(mat4_determinant3(row->pose.world_from_device) - 1) < 1e-6)) {
            abort();
        }
    }
    conus_pose_list_destroy(list);
    return 0;
}
