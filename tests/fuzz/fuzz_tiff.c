/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF stacks: directories, and the pixels where they are few enough. */
#include "base/memory.h"
#include "loaders/tiff/tiff.h"

#include <stdlib.h>

enum { PIXEL_LIMIT = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct tiff tiff;
    struct bytes pixels = {0};
    if (tiff_parse(&tiff, data, size)) {
        return 0;
    }
    if (!tiff.page_count || tiff.page_count > TIFF_PAGE_LIMIT || !tiff.page_bytes || tiff.depth < tiff.page_count ||
        tiff.page_bytes > UINT64_MAX / tiff.depth || (tiff.whole && tiff.page_bytes * tiff.depth > size)) {
        abort();
    }
    if (tiff.page_bytes * tiff.depth <= PIXEL_LIMIT && !tiff_unpack(&pixels, &tiff) &&
        pixels.size != tiff.page_bytes * tiff.depth) {
        abort();
    }
    bytes_finish(&pixels);
    tiff_finish(&tiff);
    return 0;
}
