/* SPDX-License-Identifier: BSD-3-Clause */
/* Unpacking: the first two bytes say how much the header would ask for and from where, the rest is the packed file. */
#include "base/formats/gzip.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The head and the range, which are unpacked by different code, must agree where both succeed. */
static void compare(const uint8_t *data, size_t size, struct gzip_range range)
{
    struct bytes head = {0};
    struct bytes kept = {0};
    conus_status head_status = gzip_head(&head, data, size, range.total);
    if (!gzip_unpack(&kept, &range, data, size)) {
        if (head_status || head.size != range.total || kept.size != range.count ||
            memcmp(head.data + range.from, kept.data, kept.size) != 0) {
            abort();
        }
    }
    bytes_finish(&head);
    bytes_finish(&kept);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 2) {
        return 0;
    }
    size_t total = (size_t)data[0] * 8 + 1;
    size_t from = data[1] < total ? data[1] : 0;
    compare(data + 2, size - 2, (struct gzip_range){.from = from, .count = total - from, .total = total});
    compare(data + 2, size - 2, (struct gzip_range){.from = from, .count = 1, .total = total});
    return 0;
}
