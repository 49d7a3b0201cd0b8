/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds NIfTI files in memory. */
#include "builders/nifti_builder.h"

#include "loaders/volumes/volumes.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* How a number is stored: u = unsigned byte, h, i, q = integers of 2, 4, 8 bytes, f, d = floats. */
static const struct field {
    const char *name;
    size_t offset1;
    char kind1;
    size_t offset2;
    char kind2;
} fields[] = {
    {"sizeof_hdr", 0, 'i', 0, 'i'},     {"dim", 40, 'h', 16, 'q'},          {"intent_code", 68, 'h', 504, 'i'},
    {"datatype", 70, 'h', 12, 'h'},     {"bitpix", 72, 'h', 14, 'h'},       {"pixdim", 76, 'f', 104, 'd'},
    {"vox_offset", 108, 'f', 168, 'q'}, {"scl_slope", 112, 'f', 176, 'd'},  {"scl_inter", 116, 'f', 184, 'd'},
    {"xyzt_units", 123, 'u', 500, 'i'}, {"qform_code", 252, 'h', 344, 'i'}, {"sform_code", 254, 'h', 348, 'i'},
    {"quatern", 256, 'f', 352, 'd'},    {"qoffset", 268, 'f', 376, 'd'},    {"srow", 280, 'f', 400, 'd'},
    {"magic", 344, 'u', 4, 'u'},        {"extender", 348, 'u', 540, 'u'},
};

static size_t kind_size(char kind)
{
    switch (kind) {
    case 'u':
        return 1;
    case 'h':
        return 2;
    case 'i':
    case 'f':
        return 4;
    default:
        return 8;
    }
}

static uint64_t bits_of(char kind, double value)
{
    uint64_t bits = 0;
    if (kind == 'f') {
        float single = (float)value;
        memcpy(&bits, &single, sizeof single); /* little-endian machine: low bytes */
    } else if (kind == 'd') {
        memcpy(&bits, &value, sizeof value);
    } else if (value < 0) {
        bits = (uint64_t)(int64_t)value;
    } else {
        bits = (uint64_t)value;
    }
    return bits;
}

static void order(uint8_t out[8], uint64_t bits, size_t size, bool big)
{
    for (size_t i = 0; i < size && i < sizeof bits; i++) {
        out[i] = (uint8_t)(bits >> 8 * (big ? size - 1 - i : i));
    }
}

void append_ordered(struct buffer *buffer, uint64_t bits, size_t size, bool big)
{
    uint8_t bytes[8];
    order(bytes, bits, size, big);
    buffer_append(buffer, bytes, size);
}

void append_float(struct buffer *buffer, double value, bool big)
{
    append_ordered(buffer, bits_of('f', value), 4, big);
}

void nifti_set(struct nifti_builder *builder, const char *name, size_t index, double value)
{
    size_t i = 0;
    while (strcmp(fields[i].name, name) != 0) {
        i++;
        assert_true(i < sizeof fields / sizeof fields[0]);
    }
    char kind = builder->version == 1 ? fields[i].kind1 : fields[i].kind2;
    size_t offset = builder->version == 1 ? fields[i].offset1 : fields[i].offset2;
    uint8_t *at = (uint8_t *)builder->bytes.data + offset + index * kind_size(kind);
    order(at, bits_of(kind, value), kind_size(kind), builder->big);
}

static size_t header_size(const struct nifti_builder *builder)
{
    return builder->version == 1 ? 348 : 540;
}

static void set_magic(struct nifti_builder *builder, char second)
{
    const char magic[8] = {'n', second, (char)('0' + builder->version), 0, '\r', '\n', 0x1a, '\n'};
    for (size_t i = 0; i < (builder->version == 1 ? 4 : 8); i++) {
        nifti_set(builder, "magic", i, magic[i]);
    }
}

void nifti_begin(struct nifti_builder *builder, int version, bool big, int datatype, const int64_t dim[3])
{
    static const uint8_t zeros[544];
    *builder = (struct nifti_builder){.version = version, .big = big, .datatype = datatype};
    buffer_append(&builder->bytes, zeros, header_size(builder) + 4);
    nifti_set(builder, "sizeof_hdr", 0, (double)header_size(builder));
    nifti_set(builder, "dim", 0, 3);
    nifti_set(builder, "pixdim", 0, 1);
    for (size_t i = 0; i < 3; i++) {
        nifti_set(builder, "dim", i + 1, (double)dim[i]);
        nifti_set(builder, "pixdim", i + 1, 2 + (double)i);
        nifti_set(builder, "srow", 5 * i, 2 + (double)i);
        nifti_set(builder, "srow", 4 * i + 3, -10 - 10 * (double)i);
    }
    for (size_t i = 4; i < 8; i++) {
        nifti_set(builder, "dim", i, 1);
    }
    nifti_set(builder, "sform_code", 0, 4);
    nifti_set(builder, "datatype", 0, datatype);
    nifti_set(builder, "bitpix", 0, 8 * (double)volume_datatype_size(datatype));
    nifti_set(builder, "xyzt_units", 0, 2);
    nifti_set(builder, "vox_offset", 0, (double)header_size(builder) + 4);
    set_magic(builder, '+');
}

void nifti_extend(struct nifti_builder *builder, int esize, int ecode, const void *data, size_t size)
{
    nifti_set(builder, "extender", 0, 1);
    append_ordered(&builder->bytes, (uint64_t)esize, 4, builder->big);
    append_ordered(&builder->bytes, (uint64_t)ecode, 4, builder->big);
    buffer_append(&builder->bytes, data, size);
    nifti_set(builder, "vox_offset", 0, (double)builder->bytes.size);
}

void nifti_voxel_bits(struct nifti_builder *builder, uint64_t bits)
{
    append_ordered(&builder->bytes, bits, volume_datatype_size(builder->datatype), builder->big);
}

void nifti_voxel(struct nifti_builder *builder, double value)
{
    char kind = builder->datatype == VOLUME_FLOAT32 ? 'f' : builder->datatype == VOLUME_FLOAT64 ? 'd' : 'q';
    nifti_voxel_bits(builder, bits_of(kind, value));
}

void append_gzip(struct buffer *buffer, const void *data, size_t size)
{
    z_stream z = {0};
    uLong bound = compressBound((uLong)size) + 64;
    uint8_t *packed = malloc(bound);
    assert_non_null(packed);
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = (z_const Bytef *)data;
    z.avail_in = (uInt)size;
    z.next_out = packed;
    z.avail_out = (uInt)bound;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    buffer_append(buffer, packed, z.total_out);
    deflateEnd(&z);
    free(packed);
}

const char *write_bytes(const char *name, const struct buffer *bytes)
{
    const char *path = test_scratch(name);
    FILE *stream = fopen(path, "wb"); /* file_write() would wait for the disk */
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes->data, 1, bytes->size, stream), bytes->size);
    assert_int_equal(fclose(stream), 0);
    return path;
}

const char *write_packed(const char *name, const struct buffer *bytes)
{
    struct buffer packed = {0};
    append_gzip(&packed, bytes->data, bytes->size);
    const char *path = write_bytes(name, &packed);
    buffer_finish(&packed);
    return path;
}
