/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes GIFTI documents field by field. */
#include "builders/gifti_builder.h"

#include "base/memory.h"

#include <libdeflate.h>
#include <stdint.h>
#include <string.h>

const double tetrahedron_vertices[12] = {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
const double tetrahedron_triangles[12] = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};

static const char * or (const char *given, const char *otherwise)
{
    return given ? given : otherwise;
}

static void append_base64(struct buffer *out, const struct buffer *bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < bytes->size; i += 3) {
        uint32_t group = 0;
        size_t count = bytes->size - i < 3 ? bytes->size - i : 3;
        for (size_t k = 0; k < 3; k++) {
            group = group << 8 | (k < count ? (uint8_t)bytes->data[i + k] : 0);
        }
        for (size_t k = 0; k < 4; k++) {
            buffer_append(out, k <= count ? &digits[group >> (18 - 6 * k) & 63] : "=", 1);
        }
    }
}

static void pack_bytes(struct buffer *bytes)
{
    char packed[4096];
    struct libdeflate_compressor *compressor = libdeflate_alloc_compressor(6);
    size_t size = libdeflate_zlib_compress(compressor, bytes->data, bytes->size, packed, sizeof packed);
    libdeflate_free_compressor(compressor);
    bytes->size = 0;
    buffer_append(bytes, packed, size);
}

/* One number in the stored type. */
static void append_number(struct buffer *out, double value, const char *type, bool big_endian)
{
    uint8_t bytes[8];
    size_t size = strstr(type, "64") ? 8 : strstr(type, "32") ? 4 : strstr(type, "16") ? 2 : 1;
    int64_t whole = (int64_t)value;
    float single = (float)value;
    if (strncmp(type, "FLOAT", 5) == 0) {
        memcpy(bytes, size == 8 ? (const void *)&value : (const void *)&single, size);
    } else {
        memcpy(bytes, &whole, size);
    }
    for (size_t i = 0; i < size; i++) {
        buffer_append(out, &bytes[big_endian ? size - 1 - i : i], 1);
    }
}

static void append_data(struct buffer *out, const struct array_spec *spec)
{
    struct buffer bytes = {0};
    size_t columns = spec->columns ? spec->columns : 1;
    const char *encoding = or (spec->encoding, "ASCII");
    for (size_t n = 0; n < spec->rows * columns; n++) {
        double value = spec->values[n];
        if (strcmp(encoding, "ASCII") == 0) {
            buffer_number(out, value);
            buffer_text(out, n % 3 == 2 ? "\n" : " ");
        } else {
            append_number(&bytes, value, or (spec->type, "FLOAT32"), spec->big_endian);
        }
    }
    if (strncmp(encoding, "GZip", 4) == 0) {
        pack_bytes(&bytes);
    }
    append_base64(out, &bytes);
    buffer_finish(&bytes);
}

void gifti_begin(struct buffer *out, const char *prologue, int arrays)
{
    buffer_text(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    buffer_text(out, prologue);
    buffer_format(out, "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"%d\">\n", arrays);
}

void gifti_end(struct buffer *out)
{
    buffer_text(out, "</GIFTI>\n");
}

void gifti_append(struct buffer *out, const struct array_spec *spec)
{
    buffer_format(out, "<DataArray Intent=\"NIFTI_INTENT_%s\" DataType=\"NIFTI_TYPE_%s\" Encoding=\"%s\" Endian=\"%s\"",
                  or (spec->intent, "POINTSET"), or (spec->type, "FLOAT32"), or (spec->encoding, "ASCII"),
                  spec->big_endian ? "BigEndian" : "LittleEndian");
    buffer_format(out, " ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"%d\" Dim0=\"%zu\"",
                  spec->columns ? 2 : 1, spec->rows);
    if (spec->columns) {
        buffer_format(out, " Dim1=\"%zu\"", spec->columns);
    }
    buffer_format(out, " %s>\n%s<Data>", or (spec->more, ""), or (spec->inside, ""));
    if (spec->data) {
        buffer_text(out, spec->data);
    } else {
        append_data(out, spec);
    }
    buffer_text(out, "</Data></DataArray>\n");
}

void gifti_append_tetrahedron(struct buffer *out, const char *encoding)
{
    struct array_spec spec = {.encoding = encoding, .rows = 4, .columns = 3, .values = tetrahedron_vertices};
    gifti_append(out, &spec);
    spec.intent = "TRIANGLE";
    spec.type = "INT32";
    spec.values = tetrahedron_triangles;
    gifti_append(out, &spec);
}
