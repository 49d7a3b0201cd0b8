/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-hdf5's stream of NWB electrodes: each row has a position or an error. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "poses/programs/pose_programs.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const conus_frame frame = {.space = CONUS_SPACE_CCF,
                                      .world_from_space = {0, -1e-3, 0, 0, 0, 0, -1e-3, 0, 1e-3, 0, 0, 0, 0, 0, 0, 1}};
    const conus_pose_options options = {.frame = &frame, .space = frame.space};
    struct hdf5 *hdf5 = NULL;
    conus_pose_list list = {0};
    struct bytes stream = {memory_copy(data, size, 1), size};
    conus_status status = stream.data ? hdf5_parse(&hdf5, &stream) : CONUS_ERROR_MEMORY;
    struct job job = {0};
    if (JOB_CALL(&job, status)) {
        pose_nwb_from_hdf5(&(struct pose_reading){.job = &job, .list = &list, .options = &options}, hdf5);
    }
    status = job_close(&job, NULL, NULL);
    for (size_t i = 0; !status && i < list.count; i++) {
        if (!list.rows[i].error && !vec3_is_finite(list.rows[i].pose.world_from_device + 12)) {
            abort();
        }
    }
    pose_list_finish(&list);
    hdf5_destroy(hdf5);
    return 0;
}
