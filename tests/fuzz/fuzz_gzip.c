/* SPDX-License-Identifier: BSD-3-Clause */
/* Unpacking: the first two bytes say how much the header would ask for and from where; the rest is the packed file. */
#include "base/formats/packed.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static conus_status keep_slab(void *user, const uint8_t *data, size_t size)
{
    buffer_append(user, (const char *)data, size);
    return CONUS_OK;
}

/* A sink gets the same bytes as a buffer, or both fail alike. */
static void compare_sink(const uint8_t *data, size_t size, struct gzip_range range)
{
    struct bytes kept = {0};
    struct bytes none = {0};
    struct buffer got = {0};
    struct gzip_range given = range;
    given.sink = keep_slab;
    given.user = &got;
    conus_status kept_status = gzip_unpack(&kept, &range, data, size);
    conus_status status = gzip_unpack(&none, &given, data, size);
    if (status != kept_status || none.data ||
        (!status && (given.extra != range.extra || given.junk != range.junk || got.size != kept.size ||
                     memcmp(got.data, kept.data, kept.size) != 0))) {
        abort();
    }
    bytes_finish(&kept);
    buffer_finish(&got);
}

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
    compare_sink(data, size, range);
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
