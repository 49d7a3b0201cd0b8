/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as BrainGlobe's manifest.json: no path leaves the root. */
#include "loaders/brainglobe/brainglobe_atlas.h"

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
    struct brainglobe_atlas atlas = {0};
    if (brainglobe_atlas_parse(&atlas, (struct text){(const char *)data, size})) {
        return 0;
    }
    check_place(atlas.annotation);
    check_place(atlas.terminology);
    if (atlas.template) {
        check_place(atlas.template);
    }
    brainglobe_atlas_finish(&atlas);
    return 0;
}
