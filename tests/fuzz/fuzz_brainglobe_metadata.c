/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as BrainGlobe's metadata.json. */
#include "loaders/plan/plan_brainglobe.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char orientation[BRAINGLOBE_ORIENTATION] = "asr";
    const struct text text = {(const char *)data, size};
    conus_status status = brainglobe_metadata_parse(orientation, text);
    if (!memchr(orientation, '\0', sizeof orientation) || (status && strcmp(orientation, "asr") != 0)) {
        abort();
    }
    return 0;
}
