/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF stacks: directories, and the pixels where they are few enough; then the same as a volume. */
#include "fuzz_volume.h"

#include "loaders/tiff/tiff.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    enum { PIXEL_LIMIT = 1 << 20 };
    struct job job = {0};
    struct tiff tiff;
    tiff_parse(&job, &tiff, data, size);
    if (job_ok(&job) &&
        (!tiff.pages.count || tiff.pages.count > TIFF_PAGE_LIMIT || !tiff.page_bytes || tiff.depth < tiff.pages.count ||
         tiff.page_bytes > UINT64_MAX / tiff.depth || (tiff.whole && tiff.page_bytes * tiff.depth > size))) {
        abort();
    }
    if (job_ok(&job) && tiff.page_bytes * tiff.pages.count <= PIXEL_LIMIT) {
        uint8_t *pixels = job_raw(&job, tiff.pages.count, tiff.page_bytes);
        if (pixels) {
            tiff_unpack(&job, pixels, &tiff, 0, tiff.pages.count);
        }
    }
    job_end(&job);
    fuzz_volume(data, size, FORMAT_TIFF);
    return 0;
}
