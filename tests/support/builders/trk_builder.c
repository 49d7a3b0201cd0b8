/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds TrackVis files in memory. */
#include "builders/trk_builder.h"

#include "builders/nifti_builder.h"

#include <stdint.h>
#include <string.h>

static void put(struct trk_builder *builder, size_t offset, uint64_t bits, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        size_t shift = builder->big ? size - 1 - i : i;
        builder->bytes.data[offset + i] = (char)(bits >> 8 * shift);
    }
}

void trk_put_i16(struct trk_builder *builder, size_t offset, int value)
{
    put(builder, offset, (uint64_t)(int64_t)value, 2);
}

void trk_put_i32(struct trk_builder *builder, size_t offset, int64_t value)
{
    put(builder, offset, (uint64_t)value, 4);
}

static void put_float(struct trk_builder *builder, size_t offset, double value)
{
    float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    put(builder, offset, bits, 4);
}

void trk_put_text(struct trk_builder *builder, size_t offset, const char *text, size_t size)
{
    memcpy(builder->bytes.data + offset, text, size);
}

void trk_begin(struct trk_builder *builder)
{
    static const uint8_t zeros[1000];
    buffer_clear(&builder->bytes);
    buffer_append(&builder->bytes, zeros, sizeof zeros);
    trk_put_text(builder, 0, "TRACK", 5);
    for (size_t i = 0; i < 3; i++) {
        trk_put_i16(builder, TRK_DIM + 2 * i, 10 * (int)(i + 1));
        put_float(builder, TRK_VOXEL_SIZE + 4 * i, 1);
        put_float(builder, TRK_VOX_TO_RAS + 20 * i, 1);
    }
    put_float(builder, TRK_VOX_TO_RAS + 60, 1);
    trk_put_text(builder, TRK_VOXEL_ORDER, "RAS", 3);
    trk_put_i32(builder, TRK_VERSION, 2);
    trk_put_i32(builder, TRK_HDR_SIZE, 1000);
}

void trk_append_i32(struct trk_builder *builder, int64_t value)
{
    append_ordered(&builder->bytes, (uint64_t)value, 4, builder->big);
}

void trk_append_floats(struct trk_builder *builder, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        append_float(&builder->bytes, values[i], builder->big);
    }
}
