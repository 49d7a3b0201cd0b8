/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as BrainGlobe's metadata.json. */
#include "loaders/brainglobe/brainglobe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct brainglobe_metadata metadata = {.orientation = "asr", .resolution = {25, 25, 25}};
    const struct text text = {(const char *)data, size};
    double world_from_voxel[16];
    struct job job = {0};
    brainglobe_metadata_parse(&job, &metadata, text);
    const conus_status status = job_close(&job, NULL, NULL);
    if (!memchr(metadata.orientation, '\0', sizeof metadata.orientation) ||
        (status && (strcmp(metadata.orientation, "asr") != 0 || metadata.resolution[0] != 25))) {
        abort();
    }
    if (!brainglobe_voxels(world_from_voxel, &metadata) && !isfinite(world_from_voxel[12])) {
        abort();
    }
    return 0;
}
