/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as BrainGlobe's manifest.json: no path leaves the root. */
#include "loaders/brainglobe/brainglobe.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_place(const char *place)
{
    if (place[0] == '/' || place[0] == '.' || !place[0] || strstr(place, "/.") || strstr(place, "//")) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    const struct brainglobe_atlas atlas = brainglobe_atlas_parse(&job, (struct text){(const char *)data, size});
    if (job_ok(&job)) {
        check_place(atlas.annotation);
        check_place(atlas.terminology);
        if (atlas.template) {
            check_place(atlas.template);
        }
    }
    job_end(&job);
    return 0;
}
