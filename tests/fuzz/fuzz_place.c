/* SPDX-License-Identifier: BSD-3-Clause */
/* The window's place: a text that parses is a possible window, one that does not changes nothing. */
#include "viewer/window/window.h"

#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct place before = {.width = -1, .height = -2, .x = -3, .y = -4};
    struct place place = before;
    if (place_parse(&place, (const char *)data, size)) {
        if (!place.known || place.width < 64 || place.width > 16384 || place.height < 64 || place.height > 16384 ||
            !(place.zoom == 0 || (place.zoom >= 0.5 && place.zoom <= 4))) {
            abort();
        }
    } else if (place.known || place.width != -1 || place.height != -2 || place.x != -3 || place.y != -4) {
        abort();
    }
    return 0;
}
