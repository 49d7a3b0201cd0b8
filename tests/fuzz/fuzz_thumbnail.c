/* SPDX-License-Identifier: BSD-3-Clause */
/* The picture that the start page keeps of an atlas of 5 bytes: one that does not parse changes nothing. */
#include "viewer/window/start.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct thumbnail thumbnail;
    thumbnail.areas = 77;
    if (!thumbnail_parse(&thumbnail, 5, (const char *)data, size) && thumbnail.areas != 77) {
        abort();
    }
    return 0;
}
