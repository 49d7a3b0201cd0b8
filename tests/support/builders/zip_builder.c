/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds zip archives. */
#include "builders/zip_builder.h"

#include "test.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <zlib.h>

static void append_number(struct buffer *out, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++, value >>= 8) {
        uint8_t byte = (uint8_t)value;
        buffer_append(out, &byte, 1);
    }
}

/* Raw deflate, without zlib's header and checksum. */
static void append_deflated(struct buffer *out, const void *data, size_t size)
{
    z_stream z = {0};
    uLong bound = compressBound((uLong)size) + 64;
    uint8_t *packed = malloc(bound);
    assert_non_null(packed);
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = (z_const Bytef *)data;
    z.avail_in = (uInt)size;
    z.next_out = packed;
    z.avail_out = (uInt)bound;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    buffer_append(out, packed, z.total_out);
    deflateEnd(&z);
    free(packed);
}

struct sizes {
    uint64_t stored, size, checksum;
};

/* The fields that both records share, from the flags to the length of the extra field. */
static void append_record(struct buffer *out, const struct zip_builder *builder, const struct sizes *sizes,
                          const char *name, size_t extra)
{
    append_number(out, builder->behind ? 8 : 0, 2);
    append_number(out, builder->last_is_packed ? 8 : 0, 2);
    append_number(out, 0x5a21, 4); /* time and date */
    append_number(out, sizes->checksum, 4);
    append_number(out, sizes->stored, 4);
    append_number(out, sizes->size, 4);
    append_number(out, strlen(name), 2);
    append_number(out, extra, 2);
}

/* ZIP64's field: 1, its size, and the numbers. */
static void append_wide(struct buffer *out, const struct sizes *sizes, const uint64_t *place)
{
    append_number(out, 1, 2);
    append_number(out, place ? 24 : 16, 2);
    append_number(out, sizes->size, 8);
    append_number(out, sizes->stored, 8);
    append_number(out, place ? *place : 0, place ? 8 : 0);
}

static void append_header(struct zip_builder *builder, const struct sizes *sizes, const char *name)
{
    const struct sizes wide = {0xffffffff, 0xffffffff, sizes->checksum};
    const struct sizes none = {0};
    append_number(&builder->bytes, 0x04034b50, 4);
    append_number(&builder->bytes, builder->wide ? 45 : 20, 2);
    append_record(&builder->bytes, builder,
                  builder->behind ? &none
                  : builder->wide ? &wide
                                  : sizes,
                  name, builder->wide ? 20 : 0);
    buffer_text(&builder->bytes, name);
    if (builder->wide) {
        append_wide(&builder->bytes, sizes, NULL);
    }
}

static void append_entry(struct zip_builder *builder, const struct sizes *sizes, const char *name)
{
    const struct sizes wide = {0xffffffff, 0xffffffff, sizes->checksum};
    const uint64_t place = builder->header_at;
    struct buffer *out = &builder->directory;
    append_number(out, 0x02014b50, 4);
    append_number(out, builder->wide ? 45 : 20, 2);
    append_number(out, builder->wide ? 45 : 20, 2);
    append_record(out, builder, builder->wide ? &wide : sizes, name, builder->wide ? 28 + 5 : 0);
    append_number(out, 0, 2 + 2 + 2 + 4); /* remark, disk, attributes */
    append_number(out, builder->wide ? 0xffffffff : place, 4);
    buffer_text(out, name);
    if (builder->wide) {
        append_number(out, 0x5455, 2); /* another field before it */
        append_number(out, 1, 2);
        append_number(out, 0, 1);
        append_wide(out, sizes, &place);
    }
}

void zip_add(struct zip_builder *builder, const char *name, const void *data, size_t size, bool packed)
{
    struct buffer stored = {0};
    if (packed) {
        append_deflated(&stored, data, size);
    } else {
        buffer_append(&stored, data, size);
    }
    struct sizes sizes = {stored.size, size, crc32(0, data, (uInt)size)};
    builder->last_is_packed = packed;
    builder->header_at = builder->bytes.size;
    builder->central_at = builder->directory.size;
    append_header(builder, &sizes, name);
    buffer_append(&builder->bytes, stored.data, stored.size);
    if (builder->behind) {
        append_number(&builder->bytes, 0x08074b50, 4);
        append_number(&builder->bytes, sizes.checksum, 4);
        append_number(&builder->bytes, sizes.stored, 4);
        append_number(&builder->bytes, sizes.size, 4);
    }
    append_entry(builder, &sizes, name);
    builder->count++;
    buffer_finish(&stored);
}

static void append_end64(struct buffer *out, size_t count, uint64_t size, uint64_t at)
{
    uint64_t end_at = out->size;
    append_number(out, 0x06064b50, 4);
    append_number(out, 44, 8);
    append_number(out, 45, 2);
    append_number(out, 45, 2);
    append_number(out, 0, 8); /* disks */
    append_number(out, count, 8);
    append_number(out, count, 8);
    append_number(out, size, 8);
    append_number(out, at, 8);
    append_number(out, 0x07064b50, 4);
    append_number(out, 0, 4);
    append_number(out, end_at, 8);
    append_number(out, 1, 4);
}

void zip_end(struct zip_builder *builder)
{
    struct buffer *out = &builder->bytes;
    size_t at = out->size;
    size_t size = builder->directory.size;
    bool wide = builder->wide;
    buffer_append(out, builder->directory.data, size);
    buffer_finish(&builder->directory);
    builder->central_at += at;
    if (wide) {
        append_end64(out, builder->count, size, at);
    }
    append_number(out, 0x06054b50, 4);
    append_number(out, 0, 4);
    append_number(out, wide ? 0xffff : builder->count, 2);
    append_number(out, wide ? 0xffff : builder->count, 2);
    append_number(out, wide ? 0xffffffff : size, 4);
    append_number(out, wide ? 0xffffffff : at, 4);
    append_number(out, 0, 2);
    assert_ok(buffer_status(out));
}
