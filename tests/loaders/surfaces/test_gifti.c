/* SPDX-License-Identifier: BSD-3-Clause */
/* GIFTI: every encoding, order and byte order, placement, and refused files. */
#include "loaders/surfaces/gifti.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "builders/gifti_builder.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DOCTYPE "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n"
#define MATRIX(from, to, x)                                                                                            \
    "<CoordinateSystemTransformMatrix><DataSpace>NIFTI_XFORM_" from "</DataSpace><TransformedSpace>NIFTI_XFORM_" to    \
    "</TransformedSpace><MatrixData>1 0 0 " x "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n</MatrixData>"                             \
    "</CoordinateSystemTransformMatrix>"
#define MD(name, value) "<MD><Name><![CDATA[" name "]]></Name><Value><![CDATA[" value "]]></Value></MD>"

static conus_status parse(struct gifti *out, const struct buffer *bytes, struct notes *notes)
{
    return gifti_parse(out, (const uint8_t *)bytes->data, bytes->size, NULL, notes);
}

/* Asserts that `bytes` are the tetrahedron, moved along x by `by`. */
static void assert_tetrahedron(const struct buffer *bytes, double by)
{
    struct gifti gifti = {0};
    struct mesh mesh = {0};
    struct notes notes = {0};
    assert_ok(parse(&gifti, bytes, &notes));
    assert_ok(gifti_mesh(&mesh, &gifti, false, &notes));
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.triangle_count, 4);
    for (size_t i = 0; i < 12; i++) {
        assert_near(mesh.positions[i], tetrahedron_vertices[i] + (i % 3 ? 0 : by), 1e-5);
        assert_int_equal(mesh.triangles[i], (int)tetrahedron_triangles[i]);
    }
    notes_finish(&notes);
    mesh_finish(&mesh);
    gifti_finish(&gifti);
}

static void every_encoding_order_and_endian(void **state)
{
    (void)state;
    static const char *const encodings[] = {"ASCII", "Base64Binary", "GZipBase64Binary"};
    for (int i = 0; i < 12; i++) {
        struct buffer bytes = {0};
        gifti_begin(&bytes, DOCTYPE, 2);
        gifti_append_tetrahedron(&bytes, encodings[i % 3], i / 3 % 2, i / 6);
        gifti_end(&bytes);
        assert_tetrahedron(&bytes, 0);
        buffer_finish(&bytes);
    }
}

static void every_type(void **state)
{
    (void)state;
    static const struct {
        const char *type;
        double low, high;
    } types[] = {{"UINT8", 0, 255},
                 {"INT8", -128, 127},
                 {"INT16", -32768, 32767},
                 {"UINT16", 0, 65535},
                 {"INT32", -0x1p31, 0x1p31 - 1},
                 {"UINT32", 0, 0x1p32 - 1},
                 {"INT64", -0x1p53, 0x1p53},
                 {"UINT64", 0, 0x1p53},
                 {"FLOAT32", -0.5, 0x1p100},
                 {"FLOAT64", 0.1, 1e300}};
    for (size_t i = 0; i < 4 * (sizeof types / sizeof types[0]); i++) {
        const double values[2] = {types[i / 4].low, types[i / 4].high};
        const struct array_spec spec = {.intent = "SHAPE",
                                        .type = types[i / 4].type,
                                        .encoding = i & 1 ? "Base64Binary" : "GZipBase64Binary",
                                        .big_endian = i & 2,
                                        .rows = 2,
                                        .values = values};
        struct buffer bytes = {0};
        struct gifti gifti = {0};
        struct notes notes = {0};
        gifti_begin(&bytes, "", 1);
        gifti_append(&bytes, &spec);
        gifti_end(&bytes);
        assert_ok(parse(&gifti, &bytes, &notes));
        assert_int_equal(gifti.arrays[0].intent, GIFTI_OTHER);
        assert_near(gifti.arrays[0].values[0], values[0], 0);
        assert_near(gifti.arrays[0].values[1], values[1], 0);
        gifti_finish(&gifti);
        buffer_finish(&bytes);
    }
}

/* Metadata of a POINTSET array, the shift of the vertices along x that follows, and words of the note, if there is
 * one. */
static void places_follow_the_rule(void **state)
{
    (void)state;
    static const struct {
        const char *inside;
        double by;
        const char *note;
    } cases[] = {
        {"", 0, "does not say in which space"},
        {MATRIX("UNKNOWN", "UNKNOWN", "0"), 0, "does not say in which space"},
        {"<CoordinateSystemTransformMatrix><DataSpace><![CDATA[]]></DataSpace><TransformedSpace> </TransformedSpace>"
         "<MatrixData>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MatrixData></CoordinateSystemTransformMatrix>",
         0, "does not say in which space"},
        {MATRIX("SCANNER_ANAT", "SCANNER_ANAT", "0"), 0, NULL},
        {MATRIX("MNI_152", "MNI_152", "0"), 0, NULL},
        {MATRIX("UNKNOWN", "TALAIRACH", "0"), 0, NULL},
        {MATRIX("UNKNOWN", "SCANNER_ANAT", "5"), 5, "moved by the file's matrix into scanner space"},
        {MATRIX("UNKNOWN", "ALIGNED_ANAT", "5"), 5, "moved by the file's matrix"},
        {MATRIX("SCANNER_ANAT", "TALAIRACH", "5"), 0, "the matrix from scanner to Talairach space was not applied"},
        {MATRIX("UNKNOWN", "TALAIRACH", "5"), 0, "was not applied"},
        {"<MetaData>" MD("VolGeomX_R", "-1") MD("VolGeomX_A", "0") MD("VolGeomX_S", "0") MD("VolGeomY_R", "0")
             MD("VolGeomY_A", "0") MD("VolGeomY_S", "-1") MD("VolGeomZ_R", "0") MD("VolGeomZ_A", "1")
                 MD("VolGeomZ_S", "0") MD("VolGeomC_R", "7") MD("VolGeomC_A", "0") MD("VolGeomC_S", "0") "</MetaData>",
         7, "VolGeom metadata (c_ras 7, 0, 0)"},
        {"<MetaData>" MD("VolGeomX_R", "-1") MD("VolGeomC_R", "7") "</MetaData>", 0, "does not say in which space"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct gifti gifti = {0};
        struct mesh mesh = {0};
        struct notes notes = {0};
        gifti_begin(&bytes, DOCTYPE, 2);
        gifti_append(&bytes, &(struct array_spec){
                                 .rows = 4, .columns = 3, .values = tetrahedron_vertices, .inside = cases[i].inside});
        gifti_append(
            &bytes,
            &(struct array_spec){
                .intent = "TRIANGLE", .type = "INT32", .rows = 4, .columns = 3, .values = tetrahedron_triangles});
        gifti_end(&bytes);
        assert_tetrahedron(&bytes, cases[i].by);
        assert_ok(parse(&gifti, &bytes, &notes));
        assert_ok(gifti_mesh(&mesh, &gifti, false, &notes));
        assert_int_equal(notes.count > 0, cases[i].note != NULL);
        if (cases[i].note && !strstr(notes.lines[0], cases[i].note)) {
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, notes.lines[0], cases[i].note);
        }
        mesh_finish(&mesh);
        notes_finish(&notes);
        assert_ok(gifti_mesh(&mesh, &gifti, true, &notes)); /* as stored, whatever space the file states */
        assert_near(mesh.positions[0], 0, 0);
        assert_int_equal(notes.count, 0);
        mesh_finish(&mesh);
        gifti_finish(&gifti);
        buffer_finish(&bytes);
    }
}

static void labels_names_and_hemisphere(void **state)
{
    (void)state;
    static const double values[5] = {0, 7, -1, 3, 7};
    struct buffer bytes = {0};
    struct gifti gifti = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    size_t count = 0;
    gifti_begin(&bytes, DOCTYPE, 1);
    buffer_text(
        &bytes,
        "<MetaData>" MD("Name",
                        " Area &\xc3\xbc ") "</MetaData><LabelTable>"
                                            "<Label Key=\"0\">cortex</Label><Label Key=\"-1\"><![CDATA[???]]></Label>"
                                            "<Label Index=\"7\" Red=\"1\" Green=\"0.5\" Blue=\"0\" "
                                            "Alpha=\"1\"><![CDATA[V1]]></Label>"
                                            "<Label Key=\"3\" Index=\"9\">V2</Label></LabelTable>");
    gifti_append(&bytes, &(struct array_spec){
                             .intent = "LABEL",
                             .type = "INT32",
                             .encoding = "GZipBase64Binary",
                             .rows = 5,
                             .values = values,
                             .inside = "<MetaData>" MD("AnatomicalStructurePrimary", "CortexRight") "</MetaData>"});
    gifti_end(&bytes);
    assert_ok(parse(&gifti, &bytes, &notes));
    assert_string_equal(gifti.name, "Area &\xc3\xbc");
    assert_int_equal(gifti.hemisphere, 'R');
    assert_int_equal(gifti.labels.count, 2);
    assert_string_equal(label_table_find(&gifti.labels, 3)->name, "V2");
    assert_string_equal(label_table_find(&gifti.labels, 7)->name, "V1");
    assert_int_equal(label_table_find(&gifti.labels, 7)->rgb[1], 128);
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "label 0 is called \"cortex\""));
    assert_ok(gifti_labels(&labels, &count, &gifti, 0, &notes));
    assert_int_equal(count, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_int_equal(labels[i], values[i] > 0 ? (uint32_t)values[i] : 0);
    }
    assert_non_null(strstr(notes.lines[1], "1 vertices have labels below 0"));
    memory_free(labels);
    assert_fails(gifti_labels(&labels, &count, &gifti, 1, &notes), CONUS_ERROR_DATA);
    notes_finish(&notes);
    gifti_finish(&gifti);
    buffer_finish(&bytes);
}

/* One broken array or document each; `whole` replaces all of it. */
static const struct bad {
    struct array_spec spec;
    const char *whole, *message;
    conus_status status;
} bad[] = {
    {{.dim0 = "5", .data = "0.00 0.00 0.00 1.00 0.00 0.00 0.00 1.00 0.00 0.00 0.00 1.00"},
     NULL,
     "Data: 12 numbers, the Dim attributes ask for 15",
     CONUS_ERROR_DATA},
    {{.dim0 = "3"}, NULL, "Data: 12 numbers, the Dim attributes ask for 9", CONUS_ERROR_DATA},
    {{.dim0 = "2000000000"}, NULL, "more numbers than fit", CONUS_ERROR_MEMORY},
    {{.dim0 = "100000000"}, NULL, "bytes of text, too few for the 300000000 numbers", CONUS_ERROR_DATA},
    {{.dim0 = "99999999999999999999"}, NULL, "Dim0: found \"99999999999999999999\"", CONUS_ERROR_DATA},
    {{.dim0 = "-4"}, NULL, "Dim0: found \"-4\", allowed are whole numbers from 1", CONUS_ERROR_DATA},
    {{.dim0 = "0"}, NULL, "Dim0: found \"0\"", CONUS_ERROR_DATA},
    {{.dim0 = "5", .encoding = "Base64Binary"},
     NULL,
     "Data: 48 bytes, the Dim attributes ask for 60",
     CONUS_ERROR_DATA},
    {{.dim0 = "3", .encoding = "Base64Binary"},
     NULL,
     "Data: 48 bytes, the Dim attributes ask for 36",
     CONUS_ERROR_DATA},
    {{.dim0 = "5", .encoding = "GZipBase64Binary"}, NULL, "unpacks to fewer than the 60 bytes", CONUS_ERROR_DATA},
    {{.dim0 = "3", .encoding = "GZipBase64Binary"}, NULL, "unpacks to more than the 36 bytes", CONUS_ERROR_DATA},
    {{.dim0 = "9999999", .encoding = "GZipBase64Binary"}, NULL, "packed bytes, which cannot be", CONUS_ERROR_DATA},
    {{.encoding = "Base64Binary", .data = "AA!A"},
     NULL,
     "byte 0x21 at 2, which base64 does not allow",
     CONUS_ERROR_DATA},
    {{.encoding = "Base64Binary", .data = "AAA"}, NULL, "3 base64 digits, a multiple of 4", CONUS_ERROR_DATA},
    {{.encoding = "Base64Binary", .data = "AA==AAAA"}, NULL, "byte 0x41 at 4", CONUS_ERROR_DATA},
    {{.encoding = "Base64Binary", .data = "A==="}, NULL, "byte 0x3d at 1", CONUS_ERROR_DATA},
    {{.encoding = "Base64Binary", .data = "AA==="}, NULL, "byte 0x3d at 4", CONUS_ERROR_DATA},
    {{.encoding = "GZipBase64Binary", .data = "eJxjYGiw"}, NULL, "the packed bytes are damaged", CONUS_ERROR_DATA},
    /* Python: base64.b64encode(zlib.compress(bytes(48)) + b"tail") */
    {{.encoding = "GZipBase64Binary", .data = "eJxjYCANAAAAMAABdGFpbA=="},
     NULL,
     "bytes after the packed ones",
     CONUS_ERROR_DATA},
    {{.encoding = "GZipBase64Binary", .data = ""}, NULL, "0 packed bytes|damaged", CONUS_ERROR_DATA},
    {{.data = "abc 1 2 3 4 5 6 7 8 9 10 11"}, NULL, "number 0 is \"abc\"", CONUS_ERROR_DATA},
    {{.type = "INT32", .data = "1 1 2 3 4 5.5 6 7 8 9 10 11"}, NULL, "number 5 is \"5.5\"", CONUS_ERROR_DATA},
    {{.type = "UINT8", .data = "256 1 2 3 4 5 6 7 8 9 10 11"}, NULL, "number 0 is \"256\"", CONUS_ERROR_DATA},
    {{.type = "COMPLEX64"}, NULL, "DataType: found \"NIFTI_TYPE_COMPLEX64\"", CONUS_ERROR_DATA},
    {{.encoding = "Base128"}, NULL, "Encoding: found \"Base128\"", CONUS_ERROR_DATA},
    {{.encoding = "ExternalFileBinary", .more = "ExternalFileName=\"/etc/passwd\""},
     NULL,
     "arrays in other files are not read",
     CONUS_ERROR_UNSUPPORTED},
    {{.inside = "<CoordinateSystemTransformMatrix><DataSpace>x</DataSpace></CoordinateSystemTransformMatrix>"},
     NULL,
     "DataSpace: found \"x\"",
     CONUS_ERROR_DATA},
    {{.inside = MATRIX("UNKNOWN", "NOWHERE", "0")},
     NULL,
     "TransformedSpace: found \"NIFTI_XFORM_NOWHERE\"",
     CONUS_ERROR_DATA},
    {{.inside = MATRIX("UNKNOWN", "MNI_152", "0 1")}, NULL, "MatrixData: 16 finite numbers", CONUS_ERROR_DATA},
    {{.inside = MATRIX("UNKNOWN", "MNI_152", "nan")}, NULL, "MatrixData: 16 finite numbers", CONUS_ERROR_DATA},
    {{.inside = "<Data>1 2 3 4 5 6 7 8 9 10 11 12</Data>"}, NULL, "line 9, DataArray 0: Data twice", CONUS_ERROR_DATA},
    {{.inside = "<DataArray/>"}, NULL, "DataArray inside another", CONUS_ERROR_DATA},
    {{0}, "", "not well-formed XML: no element found", CONUS_ERROR_DATA},
    {{0}, "hello", "not well-formed XML", CONUS_ERROR_DATA},
    {{0}, "<atlas/>", "outermost element: found <atlas>, allowed is <GIFTI>", CONUS_ERROR_DATA},
    {{0}, "<GIFTI Version=\"2.0\"/>", "Version: found \"2.0\"", CONUS_ERROR_UNSUPPORTED},
    {{0}, "<GIFTI NumberOfDataArrays=\"20\"/>", "NumberOfDataArrays: found 20, but 0 are there", CONUS_ERROR_DATA},
    {{0}, "<GIFTI NumberOfDataArrays=\"-2\"/>", "NumberOfDataArrays: found \"-2\"", CONUS_ERROR_DATA},
    {{0}, "<GIFTI><Data>1</Data></GIFTI>", "Data outside DataArray", CONUS_ERROR_DATA},
    {{0}, "<GIFTI><DataArray/></GIFTI>", "Intent: found \"\"", CONUS_ERROR_DATA},
    {{0},
     "<GIFTI><DataArray Intent=\"NIFTI_INTENT_LABEL\" Dimensionality=\"7\"/></GIFTI>",
     "Dimensionality: found \"7\", allowed are whole numbers from 1 to 6",
     CONUS_ERROR_DATA},
    {{0}, "<GIFTI><LabelTable><Label>x</Label></LabelTable></GIFTI>", "label \"\", a whole number", CONUS_ERROR_DATA},
    {{0}, "<GIFTI><LabelTable><Label Key=\"1.5\">x</Label></LabelTable></GIFTI>", "label \"1.5\"", CONUS_ERROR_DATA},
    {{0},
     "<!DOCTYPE GIFTI [<!ENTITY a \"x\">]><GIFTI/>",
     "a document type (<!DOCTYPE) with declarations",
     CONUS_ERROR_DATA},
    {{0}, DOCTYPE "<GIFTI><MetaData>&a;</MetaData></GIFTI>", "unknown entity &a;", CONUS_ERROR_DATA},
    {{0}, "<GIFTI><MetaData>&a;</MetaData></GIFTI>", "undefined entity", CONUS_ERROR_DATA},
};

/* Whether the message has a or b of "a|b". */
static bool says(const char *wanted)
{
    const char *bar = strchr(wanted, '|');
    char first[128];
    snprintf(first, sizeof first, "%.*s", bar ? (int)(bar - wanted) : (int)strlen(wanted), wanted);
    return strstr(conus_message(), first) || (bar && strstr(conus_message(), bar + 1));
}

static void broken_files_are_refused_with_reasons(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct buffer bytes = {0};
        struct gifti gifti = {0};
        struct notes notes = {0};
        struct array_spec spec = bad[i].spec;
        spec.rows = 4;
        spec.columns = 3;
        spec.values = tetrahedron_vertices;
        if (bad[i].whole) {
            buffer_append(&bytes, bad[i].whole, strlen(bad[i].whole));
        } else {
            gifti_begin(&bytes, DOCTYPE, 1);
            gifti_append(&bytes, &spec);
            gifti_end(&bytes);
        }
        assert_fails(parse(&gifti, &bytes, &notes), bad[i].status);
        if (!says(bad[i].message)) {
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, conus_message(), bad[i].message);
        }
        notes_finish(&notes);
        buffer_finish(&bytes);
    }
}

/* Valid arrays that do not make a surface. */
static void impossible_surfaces_are_refused(void **state)
{
    (void)state;
    static const double far[12] = {0, 2, 1, 0, 3, 2, 0, 1, 4, 1, 2, 3};
    static const double below[12] = {0, 2, 1, 0, 3, 2, 0, 1, -1, 1, 2, 3};
    static const struct {
        const char *intents[2];
        size_t columns;
        const double *triangles;
        const char *message;
    } cases[] = {
        {{"POINTSET", "SHAPE"}, 3, tetrahedron_triangles, "no TRIANGLE array"},
        {{"SHAPE", "TRIANGLE"}, 3, tetrahedron_triangles, "no POINTSET array"},
        {{"POINTSET", "TRIANGLE"}, 4, tetrahedron_triangles, "TRIANGLE array: found 2 dimensions, Dim1 = 4"},
        {{"POINTSET", "TRIANGLE"}, 0, tetrahedron_triangles, "TRIANGLE array: found 1 dimensions"},
        {{"POINTSET", "TRIANGLE"}, 3, far, "triangle 2: vertex index 4, allowed are whole numbers from 0 to 3"},
        {{"POINTSET", "TRIANGLE"}, 3, below, "triangle 2: vertex index -1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct gifti gifti = {0};
        struct mesh mesh = {0};
        struct notes notes = {0};
        size_t columns = cases[i].columns;
        gifti_begin(&bytes, "", 2);
        gifti_append(&bytes,
                     &(struct array_spec){
                         .intent = cases[i].intents[0], .rows = 4, .columns = 3, .values = tetrahedron_vertices});
        gifti_append(&bytes, &(struct array_spec){.intent = cases[i].intents[1],
                                                  .type = "INT32",
                                                  .rows = 12 / (columns ? columns : 1),
                                                  .columns = columns,
                                                  .values = cases[i].triangles});
        gifti_end(&bytes);
        assert_ok(parse(&gifti, &bytes, &notes));
        assert_fails(gifti_mesh(&mesh, &gifti, true, &notes), CONUS_ERROR_DATA);
        if (!says(cases[i].message)) {
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, conus_message(), cases[i].message);
        }
        gifti_finish(&gifti);
        buffer_finish(&bytes);
    }
}

/* Makes a document with all kinds of elements. */
static void make_rich(struct buffer *out)
{
    static const double labels[4] = {1, 2, 0, 1};
    gifti_begin(out, DOCTYPE, 3);
    buffer_text(out, "<MetaData>" MD("Name", "n") "</MetaData><LabelTable><Label Key=\"1\" Red=\"1\" Green=\"0\" "
                                                  "Blue=\"0\">a</Label><Label Key=\"2\">b</Label></LabelTable>");
    gifti_append(out, &(struct array_spec){.encoding = "Base64Binary",
                                           .rows = 4,
                                           .columns = 3,
                                           .values = tetrahedron_vertices,
                                           .inside = MATRIX("UNKNOWN", "SCANNER_ANAT", "5")});
    gifti_append(out, &(struct array_spec){.intent = "TRIANGLE",
                                           .type = "INT32",
                                           .encoding = "GZipBase64Binary",
                                           .rows = 4,
                                           .columns = 3,
                                           .values = tetrahedron_triangles});
    gifti_append(out, &(struct array_spec){.intent = "LABEL", .type = "INT32", .rows = 4, .values = labels});
    gifti_end(out);
}

static void every_prefix_is_refused(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    make_rich(&bytes);
    for (size_t size = 0; size + 1 < bytes.size; size++) { /* without its last line end it is whole */
        struct gifti gifti = {0};
        struct notes notes = {0};
        uint8_t *exact = memory_raw(size, 1); /* so that a sanitizer notices one byte too many */
        memcpy(exact, bytes.data, size);
        assert_fails(gifti_parse(&gifti, exact, size, NULL, &notes), CONUS_ERROR_DATA);
        memory_free(exact);
        notes_finish(&notes);
    }
    buffer_finish(&bytes);
}

static conus_status attempt(void *data)
{
    struct gifti gifti = {0};
    struct mesh mesh = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    size_t count;
    conus_status status = parse(&gifti, data, &notes);
    status = status ? status : gifti_mesh(&mesh, &gifti, false, &notes);
    status = status ? status : gifti_labels(&labels, &count, &gifti, 0, &notes);
    memory_free(labels);
    mesh_finish(&mesh);
    notes_finish(&notes);
    gifti_finish(&gifti);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    make_rich(&bytes);
    test_every_allocation(attempt, &bytes);
    buffer_finish(&bytes);
}

static void external_files_only_where_allowed(void **state)
{
    (void)state;
    static const float numbers[13] = {99, 0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
    static const struct {
        const char *more, *message;
        conus_status status;
    } cases[] = {
        {"ExternalFileName=\"numbers.dat\" ExternalFileOffset=\"4\"", NULL, CONUS_OK},
        {"ExternalFileName=\"numbers.dat\" ExternalFileOffset=\"8\"", "52 bytes, the array needs 48 from 8 on",
         CONUS_ERROR_DATA},
        {"ExternalFileName=\"numbers.dat\" ExternalFileOffset=\"-1\"", "ExternalFileOffset: found \"-1\"",
         CONUS_ERROR_DATA},
        {"ExternalFileName=\"../numbers.dat\"", "ExternalFileName: found \"../numbers.dat\"", CONUS_ERROR_DATA},
        {"ExternalFileName=\"/etc/passwd\"", "ExternalFileName: found \"/etc/passwd\"", CONUS_ERROR_DATA},
        {"ExternalFileName=\"\"", "ExternalFileName: found \"\"", CONUS_ERROR_DATA},
        {"ExternalFileName=\"absent.dat\"", "absent.dat", CONUS_ERROR_IO},
    };
    char path[256];
    snprintf(path, sizeof path, "%s", test_scratch("external.gii"));
    assert_ok(file_write(test_scratch("numbers.dat"), numbers, sizeof numbers));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct buffer bytes = {0};
        struct gifti gifti = {0};
        struct notes notes = {0};
        const struct gifti_options options = {.path = path, .external = true};
        gifti_begin(&bytes, "", 1);
        gifti_append(&bytes,
                     &(struct array_spec){
                         .encoding = "ExternalFileBinary", .rows = 4, .columns = 3, .data = "", .more = cases[i].more});
        gifti_end(&bytes);
        conus_status status = gifti_parse(&gifti, (const uint8_t *)bytes.data, bytes.size, &options, &notes);
        assert_fails(status, cases[i].status);
        if (status) {
            assert_true(says(cases[i].message));
        } else {
            assert_near(gifti.arrays[0].values[3], 10, 0);
        }
        gifti_finish(&gifti);
        buffer_finish(&bytes);
    }
}

TEST_GROUP(gifti)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_encoding_order_and_endian),
        cmocka_unit_test(every_type),
        cmocka_unit_test(places_follow_the_rule),
        cmocka_unit_test(labels_names_and_hemisphere),
        cmocka_unit_test(broken_files_are_refused_with_reasons),
        cmocka_unit_test(impossible_surfaces_are_refused),
        cmocka_unit_test(external_files_only_where_allowed),
        cmocka_unit_test(every_prefix_is_refused),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
