/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces of any format: the content decides the format, and labels of vertices must fit. */
#include "loaders/surfaces/surfaces.h"

#include "base/memory.h"
#include "builders/gifti_builder.h"
#include "builders/nifti_builder.h"
#include "sources/source.h"
#include "test.h"
#include "tests/support/mesh_on_job.h"

#include <stdio.h>
#include <string.h>

#define NAMED                                                                                                          \
    "<MetaData><MD><Name>Name</Name><Value>V1</Value></MD>"                                                            \
    "<MD><Name>AnatomicalStructurePrimary</Name><Value>CortexLeft</Value></MD></MetaData>"

static const struct format *format_of(const char *path)
{
    const struct format *format;
    assert_ok(source_find(&format, path, ROLE_SURFACE));
    return format;
}

static bool is_surface(const char *path)
{
    return format_of(path) != NULL;
}

static void make_gifti(struct buffer *out)
{
    gifti_begin(out, "", 2);
    buffer_text(out, NAMED);
    gifti_append_tetrahedron(out, "GZipBase64Binary");
    gifti_end(out);
}

static void make_freesurfer(struct buffer *out)
{
    buffer_append(out, "\xff\xff\xfe\n\n", 5);
    append_ordered(out, 4, 4, true);
    append_ordered(out, 4, 4, true);
    for (size_t i = 0; i < 12; i++) {
        append_float(out, tetrahedron_vertices[i], true);
    }
    for (size_t i = 0; i < 12; i++) {
        append_ordered(out, (uint64_t)tetrahedron_triangles[i], 4, true);
    }
}

/* Surfaces, packed and plain, with names of other formats: the name does not count. */
static void content_decides(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct buffer bytes = {0};
        struct mesh mesh = {0};
        struct label about = {0};
        struct notes notes = {0};
        (i & 1 ? make_gifti : make_freesurfer)(&bytes);
        const char *path = (i & 2 ? write_packed : write_bytes)("surface.obj", &bytes);
        assert_ok(mesh_file_read(&mesh, &about, path, NULL, &notes));
        assert_int_equal(mesh.triangle_count, 4);
        assert_string_equal(mesh.path, path);
        assert_near(mesh.positions[3], 10, 0);
        if (i & 1) {
            assert_string_equal(about.name, "V1");
        } else {
            assert_null(about.name);
        }
        assert_int_equal(about.hemisphere, i & 1 ? 'L' : 0);
        assert_int_equal(notes.count, 1); /* neither states its space */
        assert_non_null(strstr(notes.lines[0], path));
        notes_finish(&notes);
        label_finish(&about);
        mesh_finish(&mesh);
        buffer_finish(&bytes);
    }
}

/* Formats of other programs; all but STL number their vertices. */
static void other_formats_by_name(void **state)
{
    (void)state;
    static const char text[] = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\n";
    const struct buffer bytes = {.data = (char *)text, .size = sizeof text - 1};
    const char *path = write_bytes("tetrahedron.obj", &bytes);
    const struct mesh_file_options options = {.space = MESH_SPACE_LPS};
    struct mesh mesh = {0};
    struct label about = {0};
    struct notes notes = {0};
    assert_true(is_surface(path));
    assert_ok(mesh_file_read(&mesh, &about, path, &options, &notes));
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.triangle_count, 4);
    assert_near(mesh.positions[3], -10, 0); /* the second vertex of the file, turned */
    assert_near(mesh.positions[11], 10, 0);
    assert_true(mesh_format_keeps_vertices(format_of(path)));
    assert_true(mesh_format_is_foreign(format_of(path)));
    assert_false(mesh_format_keeps_vertices(format_of(write_bytes("any.stl", &bytes))));
    assert_null(about.name);
    assert_string_equal(mesh.path, path);
    assert_int_equal(notes.count, 0);
    mesh_finish(&mesh);
}

static void what_is_a_surface(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    const struct buffer text = {.data = (char *)"hello", .size = 5};
    make_gifti(&bytes);
    assert_true(is_surface(write_bytes("any", &bytes)));
    assert_true(is_surface(write_packed("any", &bytes)));
    assert_true(mesh_format_keeps_vertices(format_of(write_packed("any.obj", &bytes))));
    assert_false(is_surface(write_bytes("any", &text)));
    assert_false(is_surface("absent.obj"));
    assert_false(is_surface("."));
    buffer_finish(&bytes);
}

static void a_given_space_is_not_asked_of_the_file(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    make_gifti(&bytes);
    const char *path = write_bytes("space.gii", &bytes);
    for (int lps = 0; lps < 2; lps++) {
        const struct mesh_file_options options = {.space = lps ? MESH_SPACE_LPS : MESH_SPACE_RAS};
        struct mesh mesh = {0};
        struct mesh_shape shape;
        struct notes notes = {0};
        assert_ok(mesh_file_read(&mesh, NULL, path, &options, &notes));
        assert_int_equal(notes.count, 0);
        assert_near(mesh.positions[3], lps ? -10 : 10, 0);
        assert_near(mesh.positions[7], lps ? -10 : 10, 0);
        assert_near(mesh.positions[11], 10, 0);
        assert_ok(mesh_measure(&shape, &mesh));
        assert_near(shape.volume_mm3, 1000. / 6, 1e-3);
        mesh_finish(&mesh);
    }
    buffer_finish(&bytes);
}

static void errors_carry_the_path(void **state)
{
    (void)state;
    struct mesh mesh = {0};
    struct notes notes = {0};
    const struct buffer text = {.data = (char *)"hello", .size = 5};
    struct job small = {.max_memory = 4};
    const char *path = write_bytes("text.gii", &text);
    assert_fails(mesh_file_read(&mesh, NULL, path, NULL, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), path));
    assert_non_null(strstr(conus_message(), "found plain text, \"hello\"; needed is a surface (GIFTI, FreeSurfer"));
    surface_read(&small, &mesh, NULL, path, &(struct mesh_file_options){0});
    assert_fails(job_close(&small, NULL, NULL), CONUS_ERROR_MEMORY);
    assert_fails(mesh_file_read(&mesh, NULL, "absent.gii", NULL, &notes), CONUS_ERROR_IO);
}

static conus_status attempt(void *data)
{
    struct mesh mesh = {0};
    struct label about = {0};
    struct notes notes = {0};
    conus_status status = mesh_file_read(&mesh, &about, data, NULL, &notes);
    memory_free(status ? NULL : about.name);
    mesh_finish(&mesh);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    char path[256];
    make_gifti(&bytes);
    snprintf(path, sizeof path, "%s", write_packed("failing.gii.gz", &bytes));
    test_every_allocation(attempt, path);
    buffer_finish(&bytes);
}

static void make_labels(struct buffer *out, int maps)
{
    static const double labels[4] = {1, 2, 0, 1};
    gifti_begin(out, "", maps);
    buffer_text(out, NAMED "<LabelTable><Label Key=\"1\">a</Label><Label Key=\"2\">b</Label></LabelTable>");
    for (int i = 0; i < maps; i++) {
        gifti_append(out, &(struct array_spec){.intent = "LABEL", .type = "INT32", .rows = 4, .values = labels});
    }
    gifti_end(out);
}

/* An annotation with label 5, "area", of one vertex. */
static void make_annot(struct buffer *out)
{
    static const uint32_t words[] = {1, 0, 9, 1, (uint32_t)-2, 6, 0, 1, 5, 5};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        append_ordered(out, words[i], 4, true);
    }
    buffer_append(out, "area", 5);
    for (uint64_t i = 0; i < 4; i++) {
        append_ordered(out, i ? 0 : 9, 4, true);
    }
}

static void labels_of_vertices(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct buffer bytes = {0};
        struct vertex_labels labels = {0};
        struct notes notes = {0};
        if (i & 1) {
            make_labels(&bytes, 2);
        } else {
            make_annot(&bytes);
        }
        const char *path = (i & 2 ? write_packed : write_bytes)("labels", &bytes);
        assert_ok(vertex_labels_read(&labels, path, NULL, &notes));
        assert_int_equal(labels.count, i & 1 ? 4 : 1);
        assert_int_equal(labels.labels[0], i & 1 ? 1 : 5);
        assert_string_equal(label_table_find(&labels.table, labels.labels[0])->name, i & 1 ? "a" : "area");
        assert_int_equal(labels.hemisphere, i & 1 ? 'L' : 0);
        assert_int_equal(notes.count, i & 1);
        if (i & 1) {
            assert_non_null(strstr(notes.lines[0], "2 LABEL arrays: number 0 (from 0) was used"));
        }
        notes_finish(&notes);
        vertex_labels_finish(&labels);
        buffer_finish(&bytes);
    }
}

#define MAP(name) "<MetaData><MD><Name>Name</Name><Value>" name "</Value></MD></MetaData>"

/* Three maps, of which vertex 0 has label 1, 2 and 1. */
static const char *write_maps(void)
{
    static const double labels[3][4] = {{1, 1, 1, 1}, {2, 2, 2, 2}, {1, 2, 1, 2}};
    static const char *const names[3] = {MAP("aparc"), MAP("yeo"), MAP("yeo")};
    struct buffer bytes = {0};
    gifti_begin(&bytes, "", 3);
    buffer_text(&bytes, "<LabelTable><Label Key=\"1\">a</Label><Label Key=\"2\">b</Label></LabelTable>");
    for (int i = 0; i < 3; i++) {
        gifti_append(&bytes,
                     &(struct array_spec){
                         .intent = "LABEL", .type = "INT32", .rows = 4, .values = labels[i], .inside = names[i]});
    }
    gifti_end(&bytes);
    const char *path = write_bytes("maps", &bytes);
    buffer_finish(&bytes);
    return path;
}

static void maps_are_chosen_by_number_or_name(void **state)
{
    (void)state;
    static const struct {
        const char *map;
        uint32_t last; /* label of vertex 3; 0: refused */
        const char *words;
    } cases[] = {
        {"", 1,
         "3 LABEL arrays: number 0 (from 0) was used, \"aparc\"; add \",map=K\" or \",map=NAME\" to the file of "
         "labels for another of 0 \"aparc\", 1 \"yeo\", 2 \"yeo\""},
        {",map=0", 1, NULL},
        {",map=1", 2, NULL},
        {",map=2", 2, NULL},
        {",map=aparc", 1, NULL},
        {",map=3", 0, "LABEL array 3: the file has 3 (counted from 0)"},
        {",map=yeo", 0, "map: 2 LABEL arrays are called \"yeo\", one is needed of 0 \"aparc\""},
        {",map=Aparc", 0, "map: 0 LABEL arrays are called \"Aparc\""},
        {",map=", 0, "map: found \"\", a number from 0 or a name is needed"},
    };
    char file[4096];
    snprintf(file, sizeof file, "%s", write_maps());
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct vertex_labels labels = {0};
        struct notes notes = {0};
        char path[4200];
        snprintf(path, sizeof path, "%s%s", file, cases[i].map);
        conus_status status = vertex_labels_read(&labels, path, NULL, &notes);
        assert_int_equal(status == CONUS_OK, cases[i].last != 0);
        assert_true(status || labels.labels[3] == cases[i].last);
        const char *words = status ? conus_message() : notes.count ? notes.lines[0] : "";
        if (cases[i].words ? !strstr(words, cases[i].words) : words[0] != '\0') {
            fail_msg("%s: \"%s\"", cases[i].map, words);
        }
        notes_finish(&notes);
        vertex_labels_finish(&labels);
    }
}

static conus_status attempt_labels(void *data)
{
    struct vertex_labels labels = {0};
    struct notes notes = {0};
    conus_status status = vertex_labels_read(&labels, data, NULL, &notes);
    vertex_labels_finish(&labels);
    notes_finish(&notes);
    return status;
}

static void labels_without_memory_or_sense(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    struct vertex_labels labels = {0};
    struct notes notes = {0};
    char path[256];
    make_labels(&bytes, 2);
    snprintf(path, sizeof path, "%s", write_packed("labels.gii", &bytes));
    test_every_allocation(attempt_labels, path);
    char map[4200];
    snprintf(map, sizeof map, "%s,map=aparc", write_maps());
    test_every_allocation(attempt_labels, map);
    *strrchr(map, ',') = '\0';
    test_every_allocation(attempt_labels, map);
    const struct buffer text = {.data = (char *)"hello", .size = 5};
    assert_fails(vertex_labels_read(&labels, write_bytes("text.annot", &text), NULL, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "found plain text, \"hello\"; needed is labels of vertices (GIFTI or "));
    const struct buffer binary = {.data = (char *)"\0\0\1\2\3", .size = 5};
    assert_fails(vertex_labels_read(&labels, write_bytes("short.annot", &binary), NULL, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "not GIFTI, and as a FreeSurfer annotation: "));
    buffer_finish(&bytes);
}

TEST_GROUP(mesh_file)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_of_vertices),
        cmocka_unit_test(maps_are_chosen_by_number_or_name),
        cmocka_unit_test(labels_without_memory_or_sense),
        cmocka_unit_test(content_decides),
        cmocka_unit_test(other_formats_by_name),
        cmocka_unit_test(what_is_a_surface),
        cmocka_unit_test(a_given_space_is_not_asked_of_the_file),
        cmocka_unit_test(errors_carry_the_path),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
