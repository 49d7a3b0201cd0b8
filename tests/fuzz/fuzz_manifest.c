/* SPDX-License-Identifier: BSD-3-Clause */
/* Manifests: any bytes parse or are refused. */
#include "loaders/manifest/manifest.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct manifest manifest;
    if (manifest_parse(&manifest, (struct text){(const char *)data, size}) == CONUS_OK) {
        manifest_finish(&manifest);
    }
    return 0;
}
