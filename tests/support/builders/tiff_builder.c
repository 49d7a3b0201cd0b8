/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF files in memory. */
#include "builders/tiff_builder.h"

#include "builders/nifti_builder.h"

#include <string.h>

enum { MOST_FIELDS = 16, LONG = 4 };

static void append(struct tiff_builder *builder, uint64_t value, size_t size)
{
    append_ordered(&builder->bytes, value, size, false);
}

void tiff_begin(struct tiff_builder *builder)
{
    *builder = (struct tiff_builder){0};
    buffer_text(&builder->bytes, "II");
    append(builder, 42, 2);
    builder->link = builder->bytes.size;
    append(builder, 0, 4);
}

static size_t merge(struct tiff_field all[MOST_FIELDS], size_t own, const struct tiff_field *fields, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        size_t at = 0;
        while (at < own && all[at].tag != fields[i].tag) {
            at++;
        }
        all[at] = fields[i];
        own += at == own;
    }
    return own;
}

void tiff_add_page(struct tiff_builder *builder, const void *data, size_t size, const struct tiff_field *fields,
                   size_t count)
{
    const uint32_t start = (uint32_t)builder->bytes.size;
    struct tiff_field all[MOST_FIELDS] = {
        {TAG_WIDTH, 4}, {TAG_LENGTH, 3}, {TAG_BITS, 8}, {TAG_OFFSETS, start}, {TAG_COUNTS, (uint32_t)size},
    };
    size_t total = merge(all, 5, fields, count);
    buffer_append(&builder->bytes, data, size);
    const uint32_t directory = (uint32_t)builder->bytes.size; /* on a little-endian machine */
    memcpy(builder->bytes.data + builder->link, &directory, sizeof directory);
    append(builder, total, 2);
    for (size_t i = 0; i < total; i++) {
        append(builder, all[i].tag, 2);
        append(builder, LONG, 2);
        append(builder, 1, 4);
        append(builder, all[i].value, 4);
    }
    builder->link = builder->bytes.size;
    append(builder, 0, 4);
}
