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
    conus_pose_list list = {0};
    struct job job = {0};
    const struct text stream = {job_adopt(&job, memory_copy(data, size, 1)), size};
    if (stream.data) {
        pose_nwb_from_hdf5(&(struct pose_reading){.job = &job, .list = &list, .options = &options},
                           hdf5_of_stream(&job, stream));
    }
    conus_status status = job_close(&job, NULL, NULL);
    for (size_t i = 0; !status && i < list.count; i++) {
        if (!list.rows[i].error && !vec3_is_finite(list.rows[i].pose.world_from_device + 12)) {
            abort();
        }
    }
    pose_list_finish(&list);
    return 0;
}
