/* SPDX-License-Identifier: BSD-3-Clause */
/* A space that is read has a name and a scale. */
#include "poses/programs/pose_programs.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    const struct pose_space space =
        pose_coordsystem_parse(&job, (struct text){(const char *)data, size}, size % 2 ? "NIRS" : "iEEG/EEG/EMG");
    conus_status status = job_close(&job, NULL, NULL);
    if (!status && !(space.name[0] && space.scale >= 1)) {
        abort();
    }
    return 0;
}
