/* SPDX-License-Identifier: BSD-3-Clause */
/* Polylines in VTK's formats: text and binary, both layouts of cells, pieces, numbers of points and lines. All samples
 * are two lines, of 3 points and of 2, of which one point is shared; beside them is a vertex, a triangle, or both. */
#include "loaders/tracts/tract_formats.h"

#include "base/memory.h"
#include "builders/nifti_builder.h"
#include "loaders/tracts/tracts.h"
#include "sources/source.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define HEAD(version, form) "# vtk DataFile Version " version "\nlines\n" form "\nDATASET POLYDATA\n"
#define POINTS "POINTS 4 float\n0 0.5 1 2 3 4 -5 6 7 8 9 10\n"
#define NUMBERS                                                                                                        \
    "POINT_DATA 4\nSCALARS fa%20x double\nLOOKUP_TABLE default\n0.5 nan 2 3\nVECTORS dir float\n"                      \
    "1 0 0 0 1 0 0 0 1 1 1 1\nCELL_DATA 4\nFIELD FieldData 2\nweight 2 4 int\n1 2 3 4 5 6 7 8\nMETADATA\n"             \
    "INFORMATION 0\n\nlabel 1 4 string\na\nb\nc\nd\n"

/* Cells are a vertex, two lines, and a triangle; numbers of the lines are the second and third. */
static const char text_3[] = HEAD("3.0", "ASCII") POINTS "VERTICES 1 2 1 3\nLINES 2 7 3 0 1 2 2 1 3\n"
                                                         "POLYGONS 1 4 3 0 1 2\n" NUMBERS;
static const char text_5[] =
    HEAD("5.1", "ASCII") POINTS "VERTICES 2 1\nOFFSETS vtktypeint64\n0 1\nCONNECTIVITY vtktypeint64\n3\n"
                                "LINES 3 5\nOFFSETS vtktypeint64\n0 3 5\nCONNECTIVITY vtktypeint64\n0 1 2 1 3\n"
                                "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nCONNECTIVITY vtktypeint64\n0 1 2\n" NUMBERS;

#define VTP_ARRAY(type, more) "<DataArray type=\"" type "\" " more " format=\"ascii\">"
#define VTP_POINTS(numbers) "<Points>" VTP_ARRAY("Float64", "NumberOfComponents=\"3\"") numbers "</DataArray></Points>"
#define VTP_CELLS(word, corners, ends)                                                                                 \
    "<" word ">" VTP_ARRAY("Int64", "Name=\"connectivity\"") corners                                                   \
        "</DataArray>" VTP_ARRAY("Int32", "Name=\"offsets\"") ends "</DataArray></" word ">"
#define VTP_NUMBERS(fa, direction, weight)                                                                             \
    "<PointData>" VTP_ARRAY("Float32", "Name=\"fa x\"") fa                                                             \
        "</DataArray>" VTP_ARRAY("Int8", "Name=\"dir\" NumberOfComponents=\"3\"") direction                            \
        "</DataArray><Array type=\"String\" Name=\"word\" format=\"ascii\">97 0</Array></PointData>"                   \
        "<CellData>" VTP_ARRAY("UInt16", "Name=\"weight\" NumberOfComponents=\"2\"") weight "</DataArray></CellData>"

static const char vtp[] =
    "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfLines=\"2\""
    " NumberOfPolys=\"1\">" VTP_POINTS("0 0.5 1 2 3 4 -5 6 7 8 9 10") VTP_CELLS("Verts", "3", "1")
        VTP_CELLS("Lines", "0 1 2 1 3", "3 5") VTP_CELLS("Polys", "0 1 2", "3")
            VTP_NUMBERS("0.5 nan 2 3", "1 0 0 0 1 0 0 0 1 1 1 1", "1 2 3 4 5 6 7 8") "</Piece></PolyData></VTKFile>";

/* The shared point is there twice. */
static const char vtp_pieces[] =
    "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfLines=\"1\">" VTP_POINTS(
        "0 0.5 1 2 3 4 -5 6 7") VTP_CELLS("Lines", "0 1 2", "3")
        VTP_NUMBERS("0.5 nan 2", "1 0 0 0 1 0 0 0 1",
                    "3 4") "</Piece>"
                           "<Piece NumberOfPoints=\"2\" NumberOfVerts=\"1\" NumberOfLines=\"1\">" VTP_POINTS(
                               "2 3 4 8 9 10") VTP_CELLS("Verts", "0", "1") VTP_CELLS("Lines", "0 1", "2")
                               VTP_NUMBERS("nan 3", "0 1 0 1 1 1", "7 7 5 6") "</Piece></PolyData></VTKFile>";

static conus_status parse(struct tractogram *out, const char *data, size_t size, uint64_t max_memory,
                          struct notes *notes)
{
    struct job job = {0};
    struct tract_build build = {.job = &job, .max_memory = max_memory};
    /* A copy, so that a sanitizer notices one byte too many. */
    struct text copy = {job_adopt(&job, memory_copy(data, size, 1)), size};
    struct source *source = copy.data ? source_of_memory(&job, NULL, copy) : NULL;
    if (source) {
        vtk_lines_read(&job, source, &build);
    }
    if (job_ok(&job)) {
        *out = build.tractogram;
    } else {
        tractogram_finish(&build.tractogram);
    }
    return job_close(&job, notes, NULL);
}

static void assert_numbers(const struct tract_scalar *scalar, const char *name, bool per_point, uint32_t components,
                           const float *values, size_t count)
{
    assert_string_equal(scalar->name, name);
    assert_int_equal(scalar->per_point, per_point);
    assert_int_equal(scalar->components, components);
    for (size_t i = 0; i < count; i++) {
        assert_true(scalar->values[i] == values[i] || (isnan(values[i]) && isnan(scalar->values[i])));
    }
}

static void assert_lines(struct tractogram *tractogram, float sign)
{
    static const float points[15] = {0, 0.5F, 1, 2, 3, 4, -5, 6, 7, 2, 3, 4, 8, 9, 10};
    static const float fa[5] = {0.5F, NAN, 2, NAN, 3};
    static const float direction[15] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 1, 1, 1};
    static const float weight[4] = {3, 4, 5, 6};
    struct notes notes = {0};
    assert_int_equal(tractogram->streamline_count, 2);
    assert_int_equal(tractogram->point_count, 5);
    assert_int_equal(tractogram->first[1], 3);
    for (size_t i = 0; i < 15; i++) {
        assert_near(tractogram->points[i], i % 3 < 2 ? sign * points[i] : points[i], 0);
    }
    assert_int_equal(tractogram->scalar_count, 3);
    assert_numbers(&tractogram->scalars[0], "fa x", true, 1, fa, 5);
    assert_numbers(&tractogram->scalars[1], "dir", true, 3, direction, 15);
    assert_numbers(&tractogram->scalars[2], "weight", false, 2, weight, 4);
    tractogram->radius = TRACT_RADIUS;
    assert_ok(tractogram_check(tractogram, &notes));
    assert_int_equal(notes.count, 0);
}

static void put_be(struct buffer *out, uint64_t value, size_t size)
{
    for (size_t i = size; i > 0; i--) {
        uint8_t byte = (uint8_t)(value >> (8 * (i - 1)));
        buffer_append(out, &byte, 1);
    }
}

static void put_floats(struct buffer *out, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        put_be(out, bits, 4);
    }
    buffer_text(out, "\n");
}

static void put_ints(struct buffer *out, const int *values, size_t count, size_t size)
{
    for (size_t i = 0; i < count; i++) {
        put_be(out, (uint64_t)(int64_t)values[i], size);
    }
    buffer_text(out, "\n");
}

/* The same as big-endian numbers; "weight" is of bytes. */
static void build_binary(struct buffer *out, bool offsets)
{
    static const float points[12] = {0, 0.5F, 1, 2, 3, 4, -5, 6, 7, 8, 9, 10};
    static const float fa[4] = {0.5F, NAN, 2, 3};
    static const float direction[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    static const int vertex[2] = {1, 3};
    static const int lines[7] = {3, 0, 1, 2, 2, 1, 3};
    static const int ends[3] = {0, 3, 5};
    static const int corners[5] = {0, 1, 2, 1, 3};
    static const int weight[6] = {1, 2, 3, 4, 5, 6};
    buffer_text(out, offsets ? HEAD("5.1", "BINARY") : HEAD("4.2", "BINARY"));
    buffer_text(out, "POINTS 4 float\n");
    put_floats(out, points, 12);
    if (offsets) {
        buffer_text(out, "VERTICES 2 1\nOFFSETS vtktypeint64\n");
        put_ints(out, (const int[]){0, 1}, 2, 8);
        buffer_text(out, "CONNECTIVITY vtktypeint64\n");
        put_ints(out, vertex + 1, 1, 8);
        buffer_text(out, "LINES 3 5\nOFFSETS vtktypeint64\n");
        put_ints(out, ends, 3, 8);
        buffer_text(out, "CONNECTIVITY int\n");
        put_ints(out, corners, 5, 4);
    } else {
        buffer_text(out, "VERTICES 1 2\n");
        put_ints(out, vertex, 2, 4);
        buffer_text(out, "LINES 2 7\n");
        put_ints(out, lines, 7, 4);
    }
    buffer_text(out, "POINT_DATA 4\nSCALARS fa%20x float 1\nLOOKUP_TABLE table\n");
    put_floats(out, fa, 4);
    buffer_text(out, "LOOKUP_TABLE table 2\n12345678\nVECTORS dir float\n");
    put_floats(out, direction, 12);
    buffer_text(out, "CELL_DATA 3\nFIELD FieldData 1\nweight 2 3 unsigned_char\n");
    put_ints(out, weight, 6, 1);
}

static void assert_reads(const char *data, size_t size, const char *format)
{
    struct tractogram tractogram;
    struct notes notes = {0};
    const struct bytes head = {(uint8_t *)data, size};
    const enum format_id id = format_id_of(&head, ROLE_TRACTS);
    assert_true(id == FORMAT_VTK || id == FORMAT_VTP);
    assert_ok(parse(&tractogram, data, size, 1 << 20, &notes));
    assert_lines(&tractogram, 1);
    assert_string_equal(tractogram.format, format);
    assert_int_equal(tractogram.space, CONUS_FILE_SPACE_AS_STATED);
    tractogram_finish(&tractogram);
    notes_finish(&notes);
}

static void texts(void **state)
{
    (void)state;
    assert_reads(text_3, sizeof text_3 - 1, "VTK");
    assert_reads(text_5, sizeof text_5 - 1, "VTK");
    assert_reads(vtp, sizeof vtp - 1, "VTP");
    assert_reads(vtp_pieces, sizeof vtp_pieces - 1, "VTP");
    const struct bytes none = {0};
    const struct bytes mesh = {(uint8_t *)"ply\nformat", 10};
    assert_int_equal(format_id_of(&none, ROLE_TRACTS), FORMAT_OTHER);
    assert_int_equal(format_id_of(&mesh, ROLE_TRACTS), FORMAT_OTHER);
}

static void binaries(void **state)
{
    (void)state;
    for (int offsets = 0; offsets < 2; offsets++) {
        struct buffer binary = {0};
        build_binary(&binary, offsets);
        assert_reads(binary.data, binary.size, "VTK");
        buffer_finish(&binary);
    }
}

static void a_packed_file(void **state)
{
    (void)state;
    struct buffer packed = {0};
    struct tractogram tractogram;
    struct notes notes = {0};
    char sum[65];
    append_gzip(&packed, text_3, sizeof text_3 - 1);
    const struct bytes bytes = {(uint8_t *)packed.data, packed.size};
    file_sha256(sum, &bytes);
    assert_ok(file_write(test_scratch("lines.vtk.gz"), packed.data, packed.size));
    assert_ok(tract_read(&tractogram, test_scratch("lines.vtk.gz"), 1 << 20, &notes));
    assert_lines(&tractogram, 1);
    assert_string_equal(tractogram.sha256, sum);
    assert_int_equal(notes.count, 2); /* and that the space is not stated */
    assert_string_equal(notes.lines[0], "1 polygons are not read");
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    assert_fails(tract_read(&tractogram, test_scratch("lines.vtk.gz"), sizeof text_3 - 2, &notes), CONUS_ERROR_MEMORY);
    buffer_finish(&packed);
}

static void which_files_have_lines(void **state)
{
    (void)state;
    static const char surface[] = HEAD("3.0", "ASCII") POINTS "POLYGONS 1 4 3 0 1 2\n";
    static const char lines[] = HEAD("3.0", "ASCII") POINTS "LINES 2 7 3 0 1 2 2 1 3\n";
    struct tractogram tractogram;
    struct notes notes = {0};
    assert_ok(file_write(test_scratch("surface.vtk"), surface, sizeof surface - 1));
    assert_false(tract_file_is(test_scratch("surface.vtk")));
    assert_fails(tract_read(&tractogram, test_scratch("surface.vtk"), 0, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "surface.vtk: a surface and no lines"));
    assert_ok(file_write(test_scratch("lines.vtk"), lines, sizeof lines - 1));
    assert_true(tract_file_is(test_scratch("lines.vtk")));
    assert_ok(tract_read(&tractogram, test_scratch("lines.vtk"), 0, &notes));
    assert_string_equal(tractogram.path, test_scratch("lines.vtk"));
    tractogram_finish(&tractogram);
    notes_finish(&notes);
}

#define LINES HEAD("3.0", "ASCII") POINTS "LINES 2 7 3 0 1 2 2 1 3\n"
/* A point has 300 numbers and a line has it as 500 corners: 150,000 numbers of 4 bytes. */
static void memory_has_a_limit(void **state)
{
    (void)state;
    struct buffer text = {0};
    struct tractogram tractogram;
    struct notes notes = {0};
    buffer_text(&text, HEAD("3.0", "ASCII") "POINTS 1 float\n1 2 3\nLINES 1 501 500");
    for (int i = 0; i < 500; i++) {
        buffer_text(&text, " 0");
    }
    buffer_text(&text, "\nPOINT_DATA 1\nFIELD f 1\nmany 300 1 float\n");
    for (int i = 0; i < 300; i++) {
        buffer_text(&text, "1 ");
    }
    assert_fails(parse(&tractogram, text.data, text.size, 600000, &notes), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "500 times 300 numbers"));
    assert_fails(parse(&tractogram, text.data, text.size, 1000, &notes), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "many: 300 numbers"));
    assert_ok(parse(&tractogram, text.data, text.size, 606000, &notes)); /* 500 points of 12 bytes */
    assert_int_equal(tractogram.point_count, 500);
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    buffer_finish(&text);
}

/* A prefix of a file is refused or lacks numbers behind its cells; its points are never others. */
static void every_prefix(void **state)
{
    (void)state;
    struct buffer binary = {0};
    build_binary(&binary, true);
    const struct bytes samples[] = {{(uint8_t *)text_3, sizeof text_3 - 1},
                                    {(uint8_t *)text_5, sizeof text_5 - 1},
                                    {(uint8_t *)vtp, sizeof vtp - 1},
                                    {(uint8_t *)vtp_pieces, sizeof vtp_pieces - 1},
                                    {(uint8_t *)binary.data, binary.size}};
    for (size_t i = 0; i < 5; i++) {
        size_t good = 0;
        for (size_t size = 0; size < samples[i].size; size++) {
            struct tractogram tractogram = {0};
            struct notes notes = {0};
            conus_status status = parse(&tractogram, (const char *)samples[i].data, size, 1 << 20, &notes);
            assert_true(!status || status == CONUS_ERROR_DATA || status == CONUS_ERROR_UNSUPPORTED);
            assert_true(status || tractogram.streamline_count == 0 || tractogram.point_count >= 3);
            good += !status && tractogram.streamline_count == 2;
            tractogram_finish(&tractogram);
            notes_finish(&notes);
        }
        assert_true(i == 2 || i == 3 ? good == 0 : good > 0);
    }
    buffer_finish(&binary);
}

static conus_status attempt(void *data)
{
    struct tractogram tractogram = {0};
    struct notes notes = {0};
    conus_status status = tract_read(&tractogram, data, 1 << 20, &notes);
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    return status;
}

static void every_allocation(void **state)
{
    (void)state;
    char path[4096];
    snprintf(path, sizeof path, "%s", test_scratch("memory"));
    assert_ok(file_write(path, text_3, sizeof text_3 - 1));
    test_every_allocation(attempt, path);
    assert_ok(file_write(path, vtp_pieces, sizeof vtp_pieces - 1));
    test_every_allocation(attempt, path);
}

TEST_GROUP(vtk_lines)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texts),
        cmocka_unit_test(binaries),
        cmocka_unit_test(a_packed_file),
        cmocka_unit_test(which_files_have_lines),
        cmocka_unit_test(memory_has_a_limit),
        cmocka_unit_test(every_prefix),
        cmocka_unit_test(every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
