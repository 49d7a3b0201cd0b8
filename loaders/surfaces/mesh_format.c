/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a mesh in each of the formats. */
#include "loaders/surfaces/surfaces.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "conus/own.h"

#include <nettle/base64.h>
#include <stdio.h>

/* Numbers of 4 bytes, little-endian on every machine, as they are or in base64. */
enum { CHUNK_WORDS = 768 }; /* a multiple of 3, so that chunks of base64 join without padding */

struct word_writer {
    struct buffer *out;
    bool base64;
    uint8_t bytes[4 * CHUNK_WORDS];
    size_t size;
};

static void flush_words(struct word_writer *writer)
{
    char text[BASE64_ENCODE_RAW_LENGTH(4 * CHUNK_WORDS)];
    if (writer->base64) {
        base64_encode_raw(text, writer->size, writer->bytes);
        buffer_append(writer->out, text, BASE64_ENCODE_RAW_LENGTH(writer->size));
    } else {
        buffer_append(writer->out, writer->bytes, writer->size);
    }
    writer->size = 0;
}

static void put_word(struct word_writer *writer, uint32_t word)
{
    order_put(writer->bytes + writer->size, word, 4);
    writer->size += 4;
    if (writer->size == sizeof writer->bytes) {
        flush_words(writer);
    }
}

static void put_long(struct word_writer *writer, uint64_t word)
{
    put_word(writer, (uint32_t)word);
    put_word(writer, (uint32_t)(word >> 32));
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void put_positions(struct word_writer *writer, const struct mesh *mesh)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        put_word(writer, bits_of(mesh->positions[i]));
    }
}

static void put_triangles(struct word_writer *writer, const struct mesh *mesh)
{
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        put_word(writer, mesh->triangles[i]);
    }
}

void gifti_append_pair(struct buffer *out, const char *name, const char *value)
{
    buffer_format(out, "    <MD><Name>%s</Name><Value>", name);
    buffer_xml(out, value);
    buffer_text(out, "</Value></MD>\n");
}

static void append_gifti_title(struct buffer *out, const struct mesh_title *title)
{
    char text[32];
    buffer_text(out, "  <MetaData>\n");
    gifti_append_pair(out, "Name", title->name);
    snprintf(text, sizeof text, "%u", title->label);
    gifti_append_pair(out, "Label", text);
    snprintf(text, sizeof text, "#%02x%02x%02x", title->rgb[0], title->rgb[1], title->rgb[2]);
    gifti_append_pair(out, "Color", text);
    gifti_append_pair(out, "Creator", "conus " CONUS_VERSION);
    buffer_text(out, "  </MetaData>\n  <LabelTable>\n");
    buffer_format(out, "    <Label Key=\"%u\"", title->label);
    static const char *const channels[3] = {"Red", "Green", "Blue"};
    for (int i = 0; i < 3; i++) {
        buffer_format(out, " %s=\"", channels[i]);
        buffer_number(out, title->rgb[i] / 255.0);
        buffer_text(out, "\"");
    }
    buffer_text(out, " Alpha=\"1\">");
    buffer_xml(out, title->name);
    buffer_text(out, "</Label>\n  </LabelTable>\n");
}

static void append_array_start(struct buffer *out, const char *intent, const char *type, size_t rows)
{
    buffer_format(out,
                  "  <DataArray Intent=\"NIFTI_INTENT_%s\" DataType=\"NIFTI_TYPE_%s\" "
                  "ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\"%zu\" Dim1=\"3\" "
                  "Encoding=\"Base64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" ExternalFileOffset=\"\">\n"
                  "    <MetaData/>\n",
                  intent, type, rows);
}

static void append_gifti(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title)
{
    struct word_writer writer = {.out = out, .base64 = true};
    buffer_text(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n");
    append_gifti_title(out, title);
    append_array_start(out, "POINTSET", "FLOAT32", mesh->vertex_count);
    buffer_format(out,
                  "    <CoordinateSystemTransformMatrix>\n      <DataSpace>%s</DataSpace>\n"
                  "      <TransformedSpace>%s</TransformedSpace>\n"
                  "      <MatrixData>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MatrixData>\n"
                  "    </CoordinateSystemTransformMatrix>\n    <Data>",
                  title->space, title->space);
    put_positions(&writer, mesh);
    flush_words(&writer);
    buffer_text(out, "</Data>\n  </DataArray>\n");
    append_array_start(out, "TRIANGLE", "INT32", mesh->triangle_count);
    buffer_text(out, "    <Data>");
    put_triangles(&writer, mesh);
    flush_words(&writer);
    buffer_text(out, "</Data>\n  </DataArray>\n</GIFTI>\n");
}

static void append_vtp_array(struct buffer *out, const char *attributes)
{
    buffer_format(out, "        <DataArray %s format=\"binary\">", attributes);
}

static void append_string(struct buffer *out, const char *name, const char *value)
{
    buffer_format(out, "    <Array type=\"String\" Name=\"%s\" NumberOfTuples=\"1\" format=\"ascii\">", name);
    for (const char *c = value; *c; c++) {
        buffer_format(out, "%d ", (unsigned char)*c);
    }
    buffer_text(out, "0</Array>\n");
}

static void append_vtp(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title)
{
    struct word_writer writer = {.out = out, .base64 = true};
    static const char array_end[] = "</DataArray>\n";
    buffer_text(out, "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                     "header_type=\"UInt64\">\n  <PolyData>\n  <FieldData>\n");
    append_string(out, "SPACE", "RAS");
    append_string(out, "Name", title->name);
    buffer_format(out, "    <DataArray type=\"UInt32\" Name=\"Label\" NumberOfTuples=\"1\" format=\"ascii\">%u%s",
                  title->label, array_end);
    buffer_format(out, "    <DataArray type=\"UInt8\" Name=\"Color\" NumberOfTuples=\"3\" format=\"ascii\">%u %u %u%s",
                  title->rgb[0], title->rgb[1], title->rgb[2], array_end);
    buffer_format(out, "  </FieldData>\n    <Piece NumberOfPoints=\"%zu\" NumberOfPolys=\"%zu\">\n      <Points>\n",
                  mesh->vertex_count, mesh->triangle_count);
    append_vtp_array(out, "type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\"");
    put_long(&writer, 12 * (uint64_t)mesh->vertex_count);
    put_positions(&writer, mesh);
    flush_words(&writer);
    buffer_format(out, "%s      </Points>\n      <Polys>\n", array_end);
    append_vtp_array(out, "type=\"UInt32\" Name=\"connectivity\"");
    put_long(&writer, 12 * (uint64_t)mesh->triangle_count);
    put_triangles(&writer, mesh);
    flush_words(&writer);
    buffer_text(out, array_end);
    append_vtp_array(out, "type=\"Int64\" Name=\"offsets\"");
    put_long(&writer, 8 * (uint64_t)mesh->triangle_count);
    for (size_t i = 1; i <= mesh->triangle_count; i++) {
        put_long(&writer, 3 * (uint64_t)i);
    }
    flush_words(&writer);
    buffer_format(out, "%s      </Polys>\n    </Piece>\n  </PolyData>\n</VTKFile>\n", array_end);
}

static void append_ply(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title)
{
    struct word_writer writer = {.out = out};
    buffer_format(out,
                  "ply\nformat binary_little_endian 1.0\ncomment SPACE=RAS\ncomment label %u %s\n"
                  "comment color #%02x%02x%02x\nelement vertex %zu\nproperty float x\nproperty float y\n"
                  "property float z\nelement face %zu\nproperty list uchar int vertex_indices\nend_header\n",
                  title->label, title->name, title->rgb[0], title->rgb[1], title->rgb[2], mesh->vertex_count,
                  mesh->triangle_count);
    put_positions(&writer, mesh);
    flush_words(&writer);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        buffer_append(out, "\x03", 1);
        for (size_t k = 0; k < 3; k++) {
            put_word(&writer, mesh->triangles[3 * i + k]);
        }
        flush_words(&writer);
    }
}

static void put_normal(struct word_writer *writer, const struct mesh *mesh, const uint32_t triangle[3])
{
    double p[3][3];
    double normal[3];
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++) {
            p[k][a] = (double)mesh->positions[3 * (size_t)triangle[k] + (size_t)a];
        }
    }
    vec3_sub(p[1], p[1], p[0]);
    vec3_sub(p[2], p[2], p[0]);
    vec3_cross(normal, p[1], p[2]);
    vec3_normalise(normal, normal);
    for (int a = 0; a < 3; a++) {
        put_word(writer, bits_of((float)normal[a]));
    }
}

static void append_stl(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title)
{
    char header[80] = {0};
    struct word_writer writer = {.out = out};
    snprintf(header, sizeof header, "SPACE=RAS label %u %s", title->label, title->name);
    buffer_append(out, header, sizeof header);
    put_word(&writer, (uint32_t)mesh->triangle_count);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *triangle = &mesh->triangles[3 * i];
        put_normal(&writer, mesh, triangle);
        for (size_t k = 0; k < 9; k++) {
            put_word(&writer, bits_of(mesh->positions[3 * (size_t)triangle[k / 3] + k % 3]));
        }
        flush_words(&writer);
        buffer_append(out, "\0\0", 2);
    }
    flush_words(&writer);
}

static char *write_digits(char *end, uint64_t value, int least)
{
    for (int n = 0; value || n < least; n++) {
        *--end = (char)('0' + value % 10);
        value /= 10;
    }
    return end;
}

/* In nanometres: six decimals, much quicker than printf. */
static void append_millimetres(struct buffer *out, float value)
{
    char text[32];
    char *end = text + sizeof text;
    if (!(fabsf(value) < 1e9f)) {
        buffer_text(out, " ");
        buffer_number(out, (double)value);
        return;
    }
    uint64_t nanometres = (uint64_t)llround(fabs((double)value) * 1e6);
    char *at = write_digits(end, nanometres % 1000000, 6);
    *--at = '.';
    at = write_digits(at, nanometres / 1000000, 1);
    if (value < 0 && nanometres) {
        *--at = '-';
    }
    *--at = ' ';
    buffer_append(out, at, (size_t)(end - at));
}

static void append_obj(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title)
{
    buffer_format(out, "# SPACE=RAS\n# label %u color #%02x%02x%02x\no %s\n", title->label, title->rgb[0],
                  title->rgb[1], title->rgb[2], title->name);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        buffer_text(out, i % 3 ? "" : "v");
        append_millimetres(out, mesh->positions[i]);
        buffer_text(out, i % 3 == 2 ? "\n" : "");
    }
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        char text[16];
        char *end = text + sizeof text;
        char *at = write_digits(end, (uint64_t)mesh->triangles[i] + 1, 1);
        buffer_text(out, i % 3 ? " " : "f ");
        buffer_append(out, at, (size_t)(end - at));
        buffer_text(out, i % 3 == 2 ? "\n" : "");
    }
}

static const struct {
    const char *ending;
    void (*append)(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title);
} formats[] = {
    [CONUS_MESH_GIFTI] = {"gii", append_gifti}, [CONUS_MESH_VTP] = {"vtp", append_vtp},
    [CONUS_MESH_OBJ] = {"obj", append_obj},     [CONUS_MESH_PLY] = {"ply", append_ply},
    [CONUS_MESH_STL] = {"stl", append_stl},
};

const char *mesh_format_ending(conus_mesh_format format)
{
    return (size_t)format < sizeof formats / sizeof formats[0] ? formats[format].ending : NULL;
}

conus_status mesh_format(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title,
                         conus_mesh_format format)
{
    if (format == CONUS_MESH_GIFTI && mesh->vertex_count > INT32_MAX) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%zu vertices, GIFTI counts up to %d", mesh->vertex_count, INT32_MAX);
    }
    formats[format].append(out, mesh, title);
    return buffer_status(out);
}
