/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds frames of conus-hdf5. */
#include "builders/hdf5_builder.h"

#include <string.h>

static void append(struct buffer *out, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        const uint8_t byte = (uint8_t)(value >> 8 * i);
        buffer_append(out, &byte, 1);
    }
}

static void pad(struct buffer *out)
{
    while (out->size % 8 && !out->failed) {
        append(out, 0, 1);
    }
}

void hdf5_begin(struct hdf5_builder *builder)
{
    *builder = (struct hdf5_builder){0};
    buffer_append(&builder->bytes, HDF5_STREAM_MAGIC, HDF5_MAGIC_SIZE);
}

void hdf5_frame(struct hdf5_builder *builder, struct built_value value)
{
    struct buffer *out = &builder->bytes;
    size_t name = value.name ? strlen(value.name) : 0;
    append(out, value.kind, 4);
    append(out, value.class, 4);
    append(out, value.size, 4);
    append(out, value.rank, 4);
    append(out, value.address, 8);
    for (size_t i = 0; i < HDF5_RANK_LIMIT; i++) {
        append(out, value.dims[i], 8);
    }
    append(out, name, 4);
    append(out, 0, 4);
    append(out, value.data_size, 8);
    buffer_append(out, value.name, name);
    pad(out);
    if (value.data) {
        buffer_append(out, value.data, (size_t)value.data_size);
    }
    pad(out);
    builder->frames++;
}

void hdf5_doubles(struct hdf5_builder *builder, enum hdf5_frame_kind kind, const char *name, const double *values,
                  size_t count)
{
    struct buffer data = {0};
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        append(&data, bits, 8);
    }
    hdf5_frame(builder, (struct built_value){.kind = kind,
                                             .class = HDF5_FLOAT,
                                             .size = 8,
                                             .rank = 1,
                                             .dims = {count},
                                             .address = 1000 + builder->frames,
                                             .name = name,
                                             .data = data.data,
                                             .data_size = 8 * count});
    buffer_finish(&data);
}

void hdf5_strings(struct hdf5_builder *builder, enum hdf5_frame_kind kind, const char *name, const char *const *texts,
                  size_t count)
{
    struct buffer data = {0};
    uint64_t at = 0;
    append(&data, 0, 8);
    for (size_t i = 0; i < count; i++) {
        at += strlen(texts[i]);
        append(&data, at, 8);
    }
    for (size_t i = 0; i < count; i++) {
        buffer_text(&data, texts[i]);
    }
    hdf5_frame(builder, (struct built_value){.kind = kind,
                                             .class = HDF5_STRING,
                                             .rank = 1,
                                             .dims = {count},
                                             .address = 1000 + builder->frames,
                                             .name = name,
                                             .data = data.data,
                                             .data_size = data.size});
    buffer_finish(&data);
}

void hdf5_group(struct hdf5_builder *builder, const char *path)
{
    hdf5_frame(builder,
               (struct built_value){
                   .kind = HDF5_FRAME_OBJECT, .class = HDF5_GROUP, .address = 1000 + builder->frames, .name = path});
}

void hdf5_end(struct hdf5_builder *builder)
{
    hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_END, .address = builder->frames});
}
