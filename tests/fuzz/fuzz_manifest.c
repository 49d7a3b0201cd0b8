/* SPDX-License-Identifier: BSD-3-Clause */
/* Manifests: any bytes parse or are refused. */
#include "loaders/manifest/manifest.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    struct manifest manifest;
    manifest_parse(&job, &manifest, (struct text){(const char *)data, size});
    job_end(&job);
    return 0;
}
