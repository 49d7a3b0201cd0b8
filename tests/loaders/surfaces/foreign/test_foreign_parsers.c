/* SPDX-License-Identifier: BSD-3-Clause */
/* The parsers of mesh files, one by one: samples, every prefix, every failing allocation, and refused files. All
 * samples are the tetrahedron with corners at 0 and at 3 on each axis, in this order, and the faces below; the expected
 * numbers follow from that by hand. */
#include "base/buffer.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float corners[12] = {0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 3};
static const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

#define PLY_HEAD(form)                                                                                                 \
    "ply\nformat " form " 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty float x\nproperty float y\n"              \
    "property uchar red\nproperty float z\nelement edge 1\nproperty list uchar short ends\n"                           \
    "property int8 kind\nelement face 4\nproperty list uchar int vertex_indices\nproperty double area\nend_header\n"
#define VTK_HEAD(version, form) "# vtk DataFile Version " version "\nmade SPACE=RAS\n" form "\nDATASET POLYDATA\n"
#define VTK_POINTS "POINTS 4 float\n0 0 0 3 0 0 0 3 0 0 0 3\n"
#define VTP_HEAD "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" header_type=\"UInt32\""
#define VTP_PIECE                                                                                                      \
    "><PolyData><FieldData><Array type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0"     \
    "</Array></FieldData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"4\"><Points><DataArray type=\"Float32\" "         \
    "NumberOfComponents=\"3\" "
#define VTP_END "</Piece></PolyData></VTKFile>"

typedef conus_status parser(struct foreign_mesh *out, const uint8_t *data, size_t size);

static conus_status parse_obj(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    return obj_parse(out, NULL, data, size);
}

static conus_status parse_vtp(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    return vtp_parse(out, data, size, 1 << 20);
}

/* How numbers are put: little or big first. */
static void put(struct buffer *out, uint64_t value, size_t size, bool big)
{
    for (size_t i = 0; i < size; i++) {
        size_t place = big ? size - 1 - i : i;
        uint8_t byte = place < 8 ? (uint8_t)(value >> 8 * place) : 0;
        buffer_append(out, &byte, 1);
    }
}

static void put_float(struct buffer *out, float value, bool big)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(out, bits, 4, big);
}

static void build_ply(struct buffer *out, bool big)
{
    static const char little_head[] = PLY_HEAD("binary_little_endian");
    static const char big_head[] = PLY_HEAD("binary_big_endian");
    buffer_text(out, big ? big_head : little_head);
    for (int v = 0; v < 4; v++) {
        put_float(out, corners[3 * v], big);
        put_float(out, corners[3 * v + 1], big);
        put(out, 200, 1, big);
        put_float(out, corners[3 * v + 2], big);
    }
    put(out, 2, 1, big);
    put(out, 0, 2, big);
    put(out, 77, 2, big);
    put(out, 1, 1, big);
    for (int f = 0; f < 4; f++) {
        put(out, 3, 1, big);
        for (int k = 0; k < 3; k++) {
            put(out, faces[3 * f + k], 4, big);
        }
        put(out, 0, 8, big);
    }
}

static void build_ply_little(struct buffer *out)
{
    build_ply(out, false);
}

static void build_ply_big(struct buffer *out)
{
    build_ply(out, true);
}

/* A binary STL whose header begins as a text file's does. */
static void build_stl(struct buffer *out)
{
    static const char header[80] = "solid SPACE=LPS";
    buffer_append(out, header, sizeof header);
    put(out, 4, 4, false);
    for (int f = 0; f < 4; f++) {
        put(out, 0, 12, false);
        for (int k = 0; k < 9; k++) {
            put_float(out, corners[3 * faces[3 * f + k / 3] + (uint32_t)(k % 3)], false);
        }
        put(out, 0, 2, false);
    }
}

static void build_mz3(struct buffer *out)
{
    buffer_text(out, "MZ");
    put(out, 1 | 2 | 8, 2, false);
    put(out, 4, 4, false);
    put(out, 4, 4, false);
    put(out, 5, 4, false);
    buffer_text(out, "names");
    for (int i = 0; i < 12; i++) {
        put(out, faces[i], 4, false);
    }
    for (int i = 0; i < 12; i++) {
        put_float(out, corners[i], false);
    }
    for (int i = 0; i < 4; i++) {
        put(out, 7, 4, false);
    }
}

static void build_vtk(struct buffer *out)
{
    buffer_text(out, VTK_HEAD("4.2", "BINARY") "FIELD FieldData 1\nsomething 2 3 short\n");
    put(out, 0, 6, true);
    put(out, 0, 6, true);
    buffer_text(out, "\nPOINTS 4 float\n");
    for (int i = 0; i < 12; i++) {
        put_float(out, corners[i], true);
    }
    buffer_text(out, "\nMETADATA\nINFORMATION 0\n\nVERTICES 1 2\n");
    put(out, 1, 4, true);
    put(out, 0, 4, true);
    buffer_text(out, "\nPOLYGONS 4 16\n");
    for (int i = 0; i < 12; i++) {
        if (i % 3 == 0) {
            put(out, 3, 4, true);
        }
        put(out, faces[i], 4, true);
    }
}

static void build_vtk5(struct buffer *out)
{
    buffer_text(out, VTK_HEAD("5.1", "BINARY") "POINTS 4 double\n");
    for (int i = 0; i < 12; i++) {
        double wide = (double)corners[i];
        uint64_t bits;
        memcpy(&bits, &wide, sizeof bits);
        put(out, bits, 8, true);
    }
    buffer_text(out, "\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n");
    for (unsigned i = 0; i < 5; i++) {
        put(out, 3 * i, 8, true);
    }
    buffer_text(out, "\nCONNECTIVITY vtktypeint64\n");
    for (int i = 0; i < 12; i++) {
        put(out, faces[i], 8, true);
    }
}

static void build_vtp_raw(struct buffer *out)
{
    buffer_text(out, VTP_HEAD VTP_PIECE "format=\"appended\" offset=\"0\"/></Points><Polys>"
                                        "<DataArray type=\"UInt32\" Name=\"connectivity\" format=\"appended\" "
                                        "offset=\"52\"/><DataArray type=\"Int64\" Name=\"offsets\" "
                                        "format=\"ascii\">3 6 9 12</DataArray></Polys></Piece></PolyData>"
                                        "<AppendedData encoding=\"raw\">\n_");
    put(out, 48, 4, false);
    for (int i = 0; i < 12; i++) {
        put_float(out, corners[i], false);
    }
    put(out, 48, 4, false);
    for (int i = 0; i < 12; i++) {
        put(out, faces[i], 4, false);
    }
    buffer_text(out, "\n</AppendedData></VTKFile>");
}

static const struct {
    const char *name;
    parser *parse;
    const char *text;               /* the file, or ... */
    void (*build)(struct buffer *); /* its builder */
    enum mesh_space space;
    bool prefixes_are_whole; /* some of them */
} samples[] = {
    {"obj", parse_obj,
     "\xef\xbb\xbf# SPACE = LPS\r\nv 0 0 0 1 1 1\r\nvt 0 0\nv 3 \\\n 0 0\rv 0 3e0 0\n\n\tv 0 0 +3.0\nvn 0 0 1\ng a\\\n "
     "b\n"
     "usemtl x\ns off\nf 1 3 2\nf 1/1 2/1 4/1\nf -4//1 -1//1 -2//1\nl 1 2\no A\nf 2/1/1 \\\n3/1/1 4/1/1\n",
     NULL, MESH_SPACE_LPS, true},
    {"obj, faces first", parse_obj, "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nv 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3", NULL,
     MESH_SPACE_UNSTATED, true},
    {"ply, text", ply_parse,
     PLY_HEAD("ascii") "0 0 1 0\n3 0 1 0\n0 3 1 0\n0 0 1 3\n2 0 77 1\n3 0 2 1 0\n3 0 1 3 nan\n3 0 3 2 0\n3 1 2 3 0\n",
     NULL, MESH_SPACE_LPS, false},
    {"ply, little", ply_parse, NULL, build_ply_little, MESH_SPACE_LPS, false},
    {"ply, big", ply_parse, NULL, build_ply_big, MESH_SPACE_LPS, false},
    {"stl, text", stl_parse,
     "solid SPACE=RAS\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 3 0\nvertex 3 0 0\nendloop\nendfacet\n"
     "FACET NORMAL nan nan nan\nouter loop\nvertex 0 -0 0\nvertex 3 0 0\nvertex 0 0 3\nendloop\nendfacet\nendsolid\n"
     "solid two\nfacet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 3\nvertex 0 3 0\nendloop\nendfacet\n"
     "facet normal 1 1 1\nouter loop\nvertex 3 0 0\nvertex 0 3 0\nvertex 0 0 3\nendloop\nendfacet\nendsolid two\n",
     NULL, MESH_SPACE_RAS, true},
    {"stl, binary", stl_parse, NULL, build_stl, MESH_SPACE_LPS, false},
    {"off", off_parse,
     "# one\nOFF # two\n4 4 6\r\n0 0 0\n3 0 0\n\n0 3 0 0 0 3 3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2\n3 1 2 3\n", NULL,
     MESH_SPACE_UNSTATED, false},
    {"coff, one line", off_parse,
     "COFF 4 4 0\n0 0 0 1 1 1 1\n3 0 0 .5 1 1\n0 3 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3", NULL,
     MESH_SPACE_UNSTATED, false},
    {"noff", off_parse,
     "NOFF\n4 4 0\n0 0 0 1 0 0\n3 0 0 1 0 0\n0 3 0 1 0 0\n0 0 3 1 0 0\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3", NULL,
     MESH_SPACE_UNSTATED, false},
    {"off, no keyword", off_parse, "4 4 0\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3", NULL,
     MESH_SPACE_UNSTATED, false},
    {"mz3", mz3_parse, NULL, build_mz3, MESH_SPACE_UNSTATED, false},
    {"vtk, text", vtk_parse,
     VTK_HEAD("3.0", "ASCII") "FIELD F 2\na 1 2 float\n1 nan\nb 1 1 string\nx y\n" VTK_POINTS
                              "LINES 1 3\n2 0 99\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
     NULL, MESH_SPACE_RAS, false},
    {"vtk, data behind", vtk_parse,
     VTK_HEAD("3.0", "ASCII") VTK_POINTS "polygons 4 16 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3 POINT_DATA 4 anything", NULL,
     MESH_SPACE_RAS, true},
    {"vtk, offsets", vtk_parse,
     VTK_HEAD("5.1", "ASCII") VTK_POINTS "POLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\n"
                                         "CONNECTIVITY vtktypeint64\n0 2 1 0 1 3 0 3 2 1 2 3\n",
     NULL, MESH_SPACE_RAS, false},
    {"vtk, binary", vtk_parse, NULL, build_vtk, MESH_SPACE_RAS, false},
    {"vtk, binary offsets", vtk_parse, NULL, build_vtk5, MESH_SPACE_RAS, false},
    {"vtp, text", parse_vtp,
     "<?xml version=\"1.0\"?>\n" VTP_HEAD VTP_PIECE
     "format=\"ascii\">0 0 0 3 0 0 0 3 0 0 0 3<InformationKey name=\"x\"/> </DataArray></Points><Polys>"
     "<DataArray type=\"Int8\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 0 3 2 1 2 3</DataArray>"
     "<DataArray type=\"Int8\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray></Polys>" VTP_END,
     NULL, MESH_SPACE_LPS, false},
    {"vtp, base64", parse_vtp,
     VTP_HEAD VTP_PIECE "format=\"binary\">"
                        "MAAAAAAAAAAAAAAAAAAAAAAAQEAAAAAAAAAAAAAAAAAAAEBAAAAAAAAAAAAAAAAAAABAQA=="
                        "</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"binary\">"
                        "MAAAAAAAAAACAAAAAQAAAAAAAAABAAAAAwAAAAAAAAADAAAAAgAAAAEAAAACAAAAAwAAAA=="
                        "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"binary\">"
                        "IAAAAAMAAAAAAAAABgAAAAAAAAAJAAAAAAAAAAwAAAAAAAAA"
                        "</DataArray></Polys>" VTP_END,
     NULL, MESH_SPACE_LPS, false},
    {"vtp, packed", parse_vtp,
     VTP_HEAD " compressor=\"vtkZLibDataCompressor\"" VTP_PIECE "format=\"binary\">"
              "AwAAABQAAAAIAAAADwAAAA8AAAANAAAAeJxjYEAGDg4gEgAC1ACBeJxjYIABBwcYCwAE1ACBeJxjYAABBwcAAMgAgQ=="
              "</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"binary\">"
              "AQAAADAAAAAAAAAAHAAAAA==eJxjYGBgYAJiRgYIANHMUDYzkhwTlA8AAagAEw=="
              "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"binary\">"
              "AgAAABAAAAAAAAAADgAAAA4AAAA=eJxjZoAANigNAABwAAp4nONkgAAeKA0AAQAAFg=="
              "</DataArray></Polys>" VTP_END,
     NULL, MESH_SPACE_LPS, false},
    {"vtp, raw", parse_vtp, NULL, build_vtp_raw, MESH_SPACE_LPS, false},
};

enum { SAMPLES = sizeof samples / sizeof samples[0] };

static void build_sample(struct buffer *out, size_t i)
{
    if (samples[i].build) {
        samples[i].build(out);
    } else {
        buffer_text(out, samples[i].text);
    }
    assert_ok(buffer_status(out));
}

static conus_status parse_sample(struct foreign_mesh *out, size_t i, const struct buffer *bytes, size_t size)
{
    uint8_t *exact = malloc(size ? size : 1); /* so that a sanitizer notices one byte too many */
    memcpy(exact, bytes->data, size);
    conus_status status = samples[i].parse(out, exact, size);
    free(exact);
    return status;
}

/* STL has its vertices in the order in which its triangles use them: that of faces. */
static void check_tetrahedron(const struct foreign_mesh *mesh, const char *name)
{
    if (mesh->vertex_count != 4 || mesh->triangle_count != 4) {
        fail_msg("%s: %zu vertices, %zu triangles", name, mesh->vertex_count, mesh->triangle_count);
    }
    if (strncmp(name, "stl", 3) != 0) {
        assert_memory_equal(mesh->triangles, faces, sizeof faces);
    }
    for (int i = 0; i < 12; i++) {
        for (int a = 0; a < 3; a++) {
            float got = mesh->positions[3 * mesh->triangles[i] + (uint32_t)a];
            assert_true(got == corners[3 * faces[i] + (uint32_t)a]);
        }
    }
}

static void every_format_is_read(void **state)
{
    (void)state;
    for (size_t i = 0; i < SAMPLES; i++) {
        struct foreign_mesh mesh = {0};
        struct buffer bytes = {0};
        build_sample(&bytes, i);
        if (parse_sample(&mesh, i, &bytes, bytes.size)) {
            fail_msg("%s: %s", samples[i].name, conus_message());
        }
        check_tetrahedron(&mesh, samples[i].name);
        assert_int_equal(mesh.space, samples[i].space);
        foreign_mesh_finish(&mesh);
        buffer_finish(&bytes);
    }
}

/* A file that lacks no more than white space at its end is whole. */
static void every_prefix_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < SAMPLES; i++) {
        struct buffer bytes = {0};
        build_sample(&bytes, i);
        size_t whole = bytes.size;
        while (samples[i].text && strchr("\r\n", bytes.data[whole - 1])) {
            whole--;
        }
        for (size_t size = 0; size < whole; size++) {
            struct foreign_mesh mesh = {0};
            conus_status status = parse_sample(&mesh, i, &bytes, size);
            if (!status && !samples[i].prefixes_are_whole && mesh.triangle_count) {
                fail_msg("%s: %zu of %zu bytes were read", samples[i].name, size, bytes.size);
            }
            assert_true(mesh.triangle_count <= 4);
            foreign_mesh_finish(&mesh);
        }
        buffer_finish(&bytes);
    }
}

struct attempt {
    size_t sample;
    const struct buffer *bytes;
};

static conus_status attempt(void *data)
{
    const struct attempt *work = data;
    struct foreign_mesh mesh = {0};
    struct mesh taken = {0};
    conus_status status = samples[work->sample].parse(&mesh, (const uint8_t *)work->bytes->data, work->bytes->size);
    status = status ? status : foreign_mesh_take(&taken, &mesh);
    foreign_mesh_finish(&mesh);
    mesh_finish(&taken);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    for (size_t i = 0; i < SAMPLES; i++) {
        struct buffer bytes = {0};
        build_sample(&bytes, i);
        struct attempt work = {i, &bytes};
        test_every_allocation(attempt, &work);
        buffer_finish(&bytes);
    }
}

/* A further byte that is no white space is an error, except in OBJ, where it is a statement without a meaning, and
 * behind the data of VTK's format, which are not read. */
static void nothing_else_may_follow(void **state)
{
    (void)state;
    for (size_t i = 0; i < SAMPLES; i++) {
        struct foreign_mesh mesh = {0};
        struct buffer bytes = {0};
        build_sample(&bytes, i);
        buffer_text(&bytes, "?");
        bool lax = strncmp(samples[i].name, "obj", 3) == 0 || strcmp(samples[i].name, "vtk, data behind") == 0;
        if ((parse_sample(&mesh, i, &bytes, bytes.size) == CONUS_OK) != lax && i != 1) {
            fail_msg("%s with a byte more", samples[i].name);
        }
        foreign_mesh_finish(&mesh);
        buffer_finish(&bytes);
    }
}

static void refuse(parser *parse, const char *text, size_t size, const char *part)
{
    struct foreign_mesh mesh = {0};
    conus_status status = parse(&mesh, (const uint8_t *)text, size);
    foreign_mesh_finish(&mesh);
    if (status != CONUS_ERROR_DATA && status != CONUS_ERROR_UNSUPPORTED && status != CONUS_ERROR_MEMORY) {
        fail_msg("read: %.60s", text);
    }
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
}

#define REFUSE(parse, text, part) refuse(parse, text, sizeof(text) - 1, part)

static void bad_files_are_one_line(void **state)
{
    (void)state;
    REFUSE(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: vertex 4, allowed are 1 to 3");
    REFUSE(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "line 4: \"0\", a corner is the number of a vertex");
    REFUSE(parse_obj, "v 0 0 0\nv 1 0 0\nf 1 2 -3\nv 0 1 0\n", "line 3: vertex -3, allowed are -1 to -2");
    REFUSE(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "line 4: \"f 1 2\", a face has three corners or more");
    REFUSE(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3x\n", "line 4: \"3x\"");
    REFUSE(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3/a\n", "line 4: \"3/a\"");
    REFUSE(parse_obj, "v 0,5 0 0\n", "line 1: \"v 0,5 0 0\"");
    REFUSE(parse_obj, "v 0x1 0 0\n", "line 1: ");
    REFUSE(ply_parse, "ply\nformat ascii 2.0\n", "line 2: header: \"format ascii 2.0\"");
    REFUSE(ply_parse,
           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0 0\n",
           "a vertex has x, y and z");
    REFUSE(ply_parse, "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float float x\n",
           "a property has a type");
    REFUSE(ply_parse,
           "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_indices\nelement vertex 1\n"
           "property float x\nproperty float y\nproperty float z\nend_header\n0\n0 0 0\n",
           "element face before element vertex");
    REFUSE(ply_parse,
           PLY_HEAD("ascii") "0 0 1 0\n3 0 1 0\n0 3 1 0\n0 0 1 3\n2 0 77 1\n3 0 2 1.5 0\n3 0 1 3 0\n3 0 3 2 0\n"
                             "3 1 2 3 0\n",
           "face 0: vertex index -1, allowed are 0 to 3");
    REFUSE(ply_parse,
           PLY_HEAD("ascii") "0 0 1 0\n3 0 1 0\n0 3 1 0\n0 0 1 3\n2 0 77 1\n4000000 0 2 1 0 3 0 1 3 0 0 0 0 0\n",
           "face 0: a list of 4e+06 numbers");
    REFUSE(off_parse, "4OFF\n1 0 0\n", "header: \"4OFF\"");
    REFUSE(off_parse, "OFF BINARY\n", "header: a binary OFF file");
    REFUSE(off_parse, "OFF\n4000000000 1 0\n0 0 0\n", "number of vertices: 4000000000, more than");
    REFUSE(off_parse, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "face 0: vertex index 3, allowed are 0 to 2");
    REFUSE(off_parse, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n", "line 5: \"nan\"");
    REFUSE(mz3_parse, "MZ\1\0\0\0\0\0\0\0\0\0\0\0\0\0", "without vertices");
    REFUSE(mz3_parse, "MZ\3\0\377\377\377\377\377\377\377\377\377\377\377\377", "faces and 4294967295 vertices need");
    REFUSE(mz3_parse, "MZ\203\0\0\0\0\0\0\0\0\0\0\0\0\0", "attributes 131");
    REFUSE(vtk_parse, VTK_HEAD("6.0", "ASCII"), "version \"6.0\"");
    REFUSE(vtk_parse, "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n",
           "found \"UNSTRUCTURED_GRID\"");
    REFUSE(vtk_parse, VTK_HEAD("3.0", "ASCII") VTK_POINTS "POLYGONS 1 3\n3 0 1 2\n",
           "cell 0 has 3 corners, 3 numbers are left");
    REFUSE(vtk_parse, VTK_HEAD("3.0", "ASCII") VTK_POINTS "POLYGONS 1 5\n3 0 1 2\n", "1 numbers more than its 1 cells");
    REFUSE(vtk_parse, VTK_HEAD("3.0", "ASCII") VTK_POINTS "POLYGONS 1 4\n3 0 1 4\n",
           "vertex index 4, allowed are 0 to 3");
    REFUSE(vtk_parse, VTK_HEAD("5.1", "ASCII") VTK_POINTS "POLYGONS 2 3\nOFFSETS int\n0 2\nCONNECTIVITY int\n0 1 2\n",
           "OFFSETS: number 1 is 2, they rise from 0 to 3");
    REFUSE(vtk_parse, VTK_HEAD("3.0", "ASCII") "POINTS 1 float\n0 0 inf\n", "\"inf\", needed is a coordinate");
    REFUSE(parse_vtp, "<VTKFile type=\"PolyData\" compressor=\"vtkLZ4DataCompressor\"/>", "compressor is vtkLZ4");
    REFUSE(parse_vtp, "<VTKFile type=\"ImageData\"/>", "type is ImageData");
    REFUSE(parse_vtp, VTP_HEAD VTP_PIECE "format=\"appended\" offset=\"0\"/></Points>" VTP_END,
           "there is no AppendedData");
    REFUSE(parse_vtp,
           VTP_HEAD " compressor=\"vtkZLibDataCompressor\"" VTP_PIECE
                    "format=\"binary\">AQAAAP///38AAAAACAAAAA==AAAAAAAAAAA=</DataArray></Points>" VTP_END,
           "block 0 has 8 packed bytes for 2147483647");
    REFUSE(parse_vtp, VTP_HEAD VTP_PIECE "format=\"binary\">////fw==</DataArray></Points>" VTP_END,
           "cut off, or no base64");
}

TEST_GROUP(foreign_parsers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_is_read),     cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation), cmocka_unit_test(nothing_else_may_follow),
        cmocka_unit_test(bad_files_are_one_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
