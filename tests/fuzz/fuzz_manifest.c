/* SPDX-License-Identifier: BSD-3-Clause */
/* Manifests: any bytes parse or are refused; what was read can be written, and that be read. */
#include "loaders/manifest/manifest.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    struct scene scene;
    scene_read(&job, &scene, (struct text){(const char *)data, size});
    if (job_ok(&job)) {
        scene_read(&job, &scene, scene_write(&job, &scene));
    }
    job_end(&job);
    return 0;
}
