/* SPDX-License-Identifier: BSD-3-Clause */
/* A space that is read has a name and a scale. */
#include "poses/programs/pose_programs.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct pose_space space = {0};
    conus_status status =
        pose_coordsystem_parse(&space, (struct text){(const char *)data, size}, size % 2 ? "NIRS" : "iEEG/EEG/EMG");
    if (!status && !(space.name[0] && space.scale >= 1)) {
        abort();
    }
    return 0;
}
