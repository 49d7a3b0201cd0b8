/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes MATLAB's files. */
#include "builders/matlab_builder.h"

#include "builders/nifti_builder.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <zlib.h>

static void put(struct matlab_builder *builder, uint64_t bits, size_t size)
{
    append_ordered(&builder->bytes, bits, size, builder->big);
}

static void pad(struct matlab_builder *builder)
{
    while (builder->bytes.size % 8 && !builder->bytes.failed) {
        put(builder, 0, 1);
    }
}

void matlab_begin(struct matlab_builder *builder, bool big)
{
    *builder = (struct matlab_builder){.big = big};
    buffer_format(&builder->bytes, "%-116s", "MATLAB 5.0 MAT-file, written by a test");
    put(builder, 0, 8);
    put(builder, 0x100, 2);
    put(builder, 'M' << 8 | 'I', 2);
}

void matlab_element(struct matlab_builder *builder, uint32_t type, const void *data, size_t size)
{
    bool is_small = size >= 1 && size <= 4;
    put(builder, is_small ? size << 16 | type : type, 4);
    if (!is_small) {
        put(builder, size, 4);
    }
    buffer_append(&builder->bytes, data, size);
    pad(builder);
}

void matlab_open(struct matlab_builder *builder, uint32_t kind, int rows, int columns, const char *name)
{
    put(builder, MI_MATRIX, 4);
    builder->open[builder->depth++] = builder->bytes.size;
    put(builder, 0, 4); /* its size, when it is closed */
    put(builder, MI_UINT32, 4);
    put(builder, 8, 4);
    put(builder, kind, 4);
    put(builder, 0, 4);
    put(builder, MI_INT32, 4);
    put(builder, 8, 4);
    put(builder, (uint32_t)rows, 4);
    put(builder, (uint32_t)columns, 4);
    matlab_element(builder, MI_INT8, name, strlen(name));
}

void matlab_close(struct matlab_builder *builder)
{
    size_t at = builder->open[--builder->depth];
    struct buffer size = {0};
    append_ordered(&size, builder->bytes.size - at - 4, 4, builder->big);
    memcpy(builder->bytes.data + at, size.data, 4);
    buffer_finish(&size);
}

void matlab_field_names(struct matlab_builder *builder, const char *names)
{
    enum { SIZE = 32 };
    struct buffer fields = {0};
    struct text rest = text_from(names);
    struct text name;
    while (text_word(&rest, &name)) {
        char field[SIZE + 1] = {0};
        snprintf(field, sizeof field, "%.*s", (int)name.size, name.data);
        buffer_append(&fields, field, SIZE);
    }
    put(builder, 4 << 16 | MI_INT32, 4);
    put(builder, SIZE, 4);
    put(builder, MI_INT8, 4);
    put(builder, fields.size, 4);
    buffer_append(&builder->bytes, fields.data, fields.size);
    buffer_finish(&fields);
}

void matlab_values(struct matlab_builder *builder, uint32_t type, const double *values, size_t count)
{
    static const uint8_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 0, 8, 0, 0, 8, 8};
    struct buffer bytes = {0};
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = (uint64_t)(int64_t)values[i];
        float single = (float)values[i];
        if (type == MI_DOUBLE) {
            memcpy(&bits, &values[i], sizeof bits);
        } else if (type == MI_SINGLE) {
            uint32_t half;
            memcpy(&half, &single, sizeof half);
            bits = half;
        }
        append_ordered(&bytes, bits, sizes[type], builder->big);
    }
    matlab_element(builder, type, bytes.data, bytes.size);
    buffer_finish(&bytes);
}

void matlab_doubles(struct matlab_builder *builder, const char *name, int rows, int columns, const double *values)
{
    matlab_open(builder, MX_DOUBLE, rows, columns, name);
    matlab_values(builder, MI_DOUBLE, values, (size_t)rows * (size_t)columns);
    matlab_close(builder);
}

void matlab_chars(struct matlab_builder *builder, const char *name, const uint16_t *units, int count)
{
    struct buffer bytes = {0};
    for (int i = 0; i < count; i++) {
        append_ordered(&bytes, units[i], 2, builder->big);
    }
    matlab_open(builder, MX_CHAR, 1, count, name);
    matlab_element(builder, MI_UINT16, bytes.data, bytes.size);
    matlab_close(builder);
    buffer_finish(&bytes);
}

void matlab_pack(struct matlab_builder *builder, size_t from)
{
    const char *plain = builder->bytes.data + from;
    uLong size = builder->bytes.size - from;
    uLongf packed_size = compressBound(size);
    Bytef *packed = malloc(packed_size);
    if (!packed || compress(packed, &packed_size, (const Bytef *)plain, size) != Z_OK) {
        abort();
    }
    builder->bytes.size = from;
    put(builder, MI_COMPRESSED, 4);
    put(builder, packed_size, 4);
    buffer_append(&builder->bytes, packed, packed_size);
    free(packed);
}

struct text matlab_built(const struct matlab_builder *builder)
{
    return (struct text){builder->bytes.data, builder->bytes.size};
}
