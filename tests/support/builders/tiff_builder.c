/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF files in memory. */
#include "builders/tiff_builder.h"

#include "builders/nifti_builder.h"
#include "loaders/tiff/tiff.h"

#include <string.h>

enum { MOST_FIELDS = 32, LONG = 4, LONG8 = 16 };

static void append(struct tiff_builder *builder, uint64_t value, size_t size)
{
    append_ordered(&builder->bytes, value, size, builder->big_endian);
}

static size_t offset_size(const struct tiff_builder *builder)
{
    return builder->big ? 8 : 4;
}

void tiff_put(struct tiff_builder *builder, size_t at, uint64_t value)
{
    struct buffer number = {0};
    append_ordered(&number, value, offset_size(builder), builder->big_endian);
    memcpy(builder->bytes.data + at, number.data, number.size);
    buffer_finish(&number);
}

void tiff_begin(struct tiff_builder *builder, bool big_endian, bool big)
{
    *builder = (struct tiff_builder){.big_endian = big_endian, .big = big};
    buffer_text(&builder->bytes, big_endian ? "MM" : "II");
    append(builder, big ? 43 : 42, 2);
    if (big) {
        append(builder, 8, 2);
        append(builder, 0, 2);
    }
    builder->link = builder->bytes.size;
    append(builder, 0, offset_size(builder));
}

void tiff_link(struct tiff_builder *builder, uint64_t offset)
{
    tiff_put(builder, builder->link, offset);
}

/* Values are in the entry itself, at its left. */
static void append_field(struct tiff_builder *builder, const struct tiff_field *field)
{
    static const size_t sizes[] = {0, 1, 1, 2, 4, 8, [16] = 8};
    uint16_t type = field->type ? field->type : LONG;
    size_t size = type <= 16 && sizes[type] && sizes[type] <= offset_size(builder) ? sizes[type] : offset_size(builder);
    append(builder, field->tag, 2);
    append(builder, type, 2);
    append(builder, field->count ? field->count : 1, offset_size(builder));
    size = field->count * size > offset_size(builder) ? offset_size(builder) : size; /* then it is an offset */
    append(builder, field->value, size);
    append(builder, 0, offset_size(builder) - size);
}

static size_t merge(struct tiff_field all[MOST_FIELDS], size_t own, const struct tiff_field *fields, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        size_t at = 0;
        while (at < own && all[at].tag != fields[i].tag) {
            at++;
        }
        bool more = at == own || fields[i].twice;
        all[more ? own : at] = fields[i];
        own += more;
    }
    return own;
}

void tiff_add_page(struct tiff_builder *builder, const void *data, size_t size, const struct tiff_field *fields,
                   size_t count)
{
    size_t start = builder->bytes.size;
    struct tiff_field all[MOST_FIELDS] = {
        {.tag = TAG_WIDTH, .value = 4},       {.tag = TAG_LENGTH, .value = 3},    {.tag = TAG_BITS, .value = 8},
        {.tag = TAG_OFFSETS, .value = start}, {.tag = TAG_COUNTS, .value = size},
    };
    size_t total = merge(all, 5, fields, count);
    size_t kept = 0;
    for (size_t i = 0; i < total; i++) {
        kept += !all[i].missing;
    }
    buffer_append(&builder->bytes, data, size);
    builder->directory = builder->bytes.size;
    tiff_link(builder, builder->directory);
    append(builder, kept, builder->big ? 8 : 2);
    for (size_t i = 0; i < total; i++) {
        if (!all[i].missing) {
            append_field(builder, &all[i]);
        }
    }
    builder->link = builder->bytes.size;
    append(builder, 0, offset_size(builder));
}

conus_status tiff_read_page(struct bytes *out, const void *packed, size_t size, const struct tiff_field *fields,
                            size_t count)
{
    struct tiff_builder b;
    struct tiff tiff;
    tiff_begin(&b, false, false);
    tiff_add_page(&b, packed, size, fields, count);
    conus_status status = tiff_parse(&tiff, (const uint8_t *)b.bytes.data, b.bytes.size);
    if (!status) {
        status = tiff_unpack(out, &tiff);
        tiff_finish(&tiff);
    }
    buffer_finish(&b.bytes);
    return status;
}
