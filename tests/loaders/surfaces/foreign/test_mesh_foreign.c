/* SPDX-License-Identifier: BSD-3-Clause */
/* Mesh files of other programs: several at once, and spaces that the caller knows. tests/corpus/foreign/ has each
 * format, and files that break other readers. */
#include "base/files/file.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/surfaces/foreign/foreign.h"
#include "loaders/surfaces/surfaces.h"
#include "sources/source.h"
#include "test.h"
#include "tests/support/mesh_on_job.h"

#include <stdio.h>
#include <string.h>

static const char *write_text(const char *name, const char *text, size_t size)
{
    const char *path = test_scratch(name);
    assert_ok(file_write_soon(path, text, size));
    return path;
}

/* A cube of 3 mm, and the unit tetrahedron scaled by 3: volume 4.5, centroid 0.75 in each of x, y and z. */
static const char quads[] = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 0 0 3\nv 3 0 3\nv 3 3 3\nv 0 3 3\n"
                            "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
static const char ply[] = "ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty float x\n"
                          "property float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\n"
                          "end_header\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
static void read_one(struct mesh *mesh, const char *path, enum mesh_space space, struct notes *notes)
{
    const char *const paths[] = {path};
    if (mesh_foreign_read(mesh, paths, 1, space, notes)) {
        fail_msg("%s", conus_message());
    }
    assert_string_equal(mesh->path, path);
}

/* Asserts the volume, and the centroid: `at` in x and y, `up` in z. */
static void check_shape(struct mesh *mesh, double volume, double at, double up)
{
    struct mesh_shape shape;
    assert_ok(mesh_measure(&shape, mesh));
    assert_true(shape.closed);
    assert_near(shape.volume_mm3, volume, 1e-5);
    assert_near(shape.centroid[0], at, 1e-5);
    assert_near(shape.centroid[1], at, 1e-5);
    assert_near(shape.centroid[2], up, 1e-5);
    mesh_finish(mesh);
}

/* A file of three tetrahedra: one before the first object, "left", and "right side" in two pieces. The sizes are 3, 6
 * and 1, with the volumes 27 / 6, 216 / 6 and 1 / 6; "right side" has the four faces of the third in two lots. */
static const char objects[] = "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
                              "o left\nv 10 0 0\nv 16 0 0\nv 10 6 0\nv 10 0 6\n"
                              "g one\nf 5 7 6\nf 5 6 8\ng two\nf 5 8 7\nf 6 7 8\n"
                              "o right side\r\nv 20 0 0\nv 21 0 0\nv 20 1 0\nv 20 0 1\nf 9 11 10\nf 9 10 12\n"
                              "o nothing\no right side \nf 9 12 11\n  f 10 11 12\n";

/* A request for single files makes one surface of them, since a manifest's entry is one area. */
static void a_file_of_many_objects_may_be_one_surface(void **state)
{
    (void)state;
    struct mesh mesh;
    struct notes notes = {0};
    read_one(&mesh, write_text("objects.obj", objects, sizeof objects - 1), MESH_SPACE_UNSTATED, &notes);
    assert_int_equal(mesh.triangle_count, 12);
    notes_finish(&notes);
    mesh_finish(&mesh);
}

static void the_caller_may_know_the_space_better(void **state)
{
    (void)state;
    struct mesh mesh;
    struct notes notes = {0};
    read_one(&mesh, write_text("cube.obj", quads, sizeof quads - 1), MESH_SPACE_LPS, &notes);
    check_shape(&mesh, 27, -1.5, 1.5);
    read_one(&mesh, write_text("lps.ply", ply, sizeof ply - 1), MESH_SPACE_RAS, &notes);
    check_shape(&mesh, 4.5, 0.75, 0.75);
    assert_int_equal(notes.count, 0);
}

/* mesh_file_read() passes these files on to this reader. */
static void mesh_file_read_leads_here(void **state)
{
    (void)state;
    static const char freesurfer[] = "\xff\xff\xfe"
                                     "created by someone\n\n\0\0\0\4";
    const struct mesh_file_options ras = {.space = MESH_SPACE_RAS};
    struct mesh mesh;
    struct label about = {.number = 7};
    struct notes notes = {0};
    const char *path = write_text("lps.ply", ply, sizeof ply - 1);
    assert_ok(mesh_file_read(&mesh, &about, path, NULL, &notes));
    assert_null(about.name);
    check_shape(&mesh, 4.5, -0.75, 0.75);
    assert_ok(mesh_file_read(&mesh, NULL, path, &ras, &notes));
    check_shape(&mesh, 4.5, 0.75, 0.75);
    path = write_text("lh.obj", freesurfer, sizeof freesurfer - 1);
    assert_fails(mesh_file_read(&mesh, NULL, path, NULL, &notes), CONUS_ERROR_DATA);
    assert_null(strstr(conus_message(), "VTK")); /* the content decides, not the name */
    notes_finish(&notes);
}

/* A file written by conus mesh is read back unchanged. */
static void what_we_write_is_read(void **state)
{
    (void)state;
    float positions[12] = {0, 0, 0, 3.25f, 0, 0, 0, 3.25f, 0, 0, 0, 3.25f};
    uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const struct mesh mesh = {.positions = positions, .vertex_count = 4, .triangles = triangles, .triangle_count = 4};
    const struct mesh_title title = {.label = 5, .name = "A & <B> \"C\"", .space = "NIFTI_XFORM_MNI_152"};
    for (int format = CONUS_MESH_VTP; format <= CONUS_MESH_STL; format++) {
        char name[32];
        struct buffer bytes = {0};
        struct mesh back;
        struct notes notes = {0};
        assert_ok(mesh_format(&bytes, &mesh, &title, (conus_mesh_format)format));
        snprintf(name, sizeof name, "ours.%s", mesh_format_ending((conus_mesh_format)format));
        read_one(&back, write_text(name, bytes.data, bytes.size), MESH_SPACE_UNSTATED, &notes);
        assert_int_equal(notes.count, 0);
        assert_int_equal(back.vertex_count, 4);
        assert_int_equal(back.triangle_count, 4);
        check_shape(&back, 3.25 * 3.25 * 3.25 / 6, 3.25 / 4, 3.25 / 4);
        buffer_finish(&bytes);
    }
}

enum { STL_HEADER = 84, STL_SIZE = STL_HEADER + 4 * 50 };

static void one_bad_file_among_many_is_named(void **state)
{
    (void)state;
    char good[256];
    char bad[256];
    snprintf(good, sizeof good, "%s", write_text("cube.obj", quads, sizeof quads - 1));
    snprintf(bad, sizeof bad, "%s", write_text("far.obj", "v 0 0 0\nf 1 2 999999\n", 21));
    const char *const paths[] = {good, good, bad, good};
    struct mesh meshes[4] = {0};
    struct notes notes = {0};
    assert_true(mesh_foreign_read(meshes, paths, 4, MESH_SPACE_UNSTATED, &notes) != CONUS_OK);
    assert_non_null(strstr(conus_message(), "far.obj: "));
    assert_null(meshes[0].positions);
    notes_finish(&notes);
    assert_ok(mesh_foreign_read(meshes, paths, 2, MESH_SPACE_UNSTATED, &notes));
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "2 mesh files do not state their space"));
    mesh_finish(&meshes[0]);
    mesh_finish(&meshes[1]);
    notes_finish(&notes);
}

/* The same cube of 2 mm in four files, its triangles not all turned the same way. */
static void real_files_are_read(void **state)
{
    (void)state;
    static const char *const cubes[] = {"cube.vtk", "cube.ply", "cube.stl", "cube_bin.stl"};
    for (size_t i = 0; i < sizeof cubes / sizeof cubes[0]; i++) {
        char name[64];
        struct mesh mesh;
        struct mesh_shape shape;
        struct notes notes = {0};
        snprintf(name, sizeof name, "meshes/format-zoo/%s", cubes[i]);
        read_one(&mesh, test_shared(name), MESH_SPACE_UNSTATED, &notes);
        assert_ok(mesh_measure(&shape, &mesh));
        assert_int_equal(mesh.vertex_count, 8);
        assert_int_equal(mesh.triangle_count, 12);
        for (int a = 0; a < 3; a++) {
            assert_near(shape.low[a], -1, 1e-6);
            assert_near(shape.high[a], 1, 1e-6);
            assert_near(shape.centroid[a], 0, 1e-6);
        }
        notes_finish(&notes);
        mesh_finish(&mesh);
    }
}

static conus_status attempt(void *data)
{
    const char *const paths[] = {data, data};
    struct mesh meshes[2];
    struct notes notes = {0};
    conus_status status = mesh_foreign_read(meshes, paths, 2, MESH_SPACE_UNSTATED, &notes);
    for (int i = 0; !status && i < 2; i++) {
        mesh_finish(&meshes[i]);
    }
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    char path[256];
    snprintf(path, sizeof path, "%s", write_text("cube.obj", quads, sizeof quads - 1));
    test_every_allocation(attempt, path);
}

/* FORMAT_OTHER where only the name says that it is a surface, -1 where nothing does. */
static int id_of(const char *path, const char *text)
{
    const struct bytes bytes = {(uint8_t *)text, strlen(text)};
    const struct file_head head = head_of(path, &bytes);
    const struct format *format = format_find(&head, ROLE_SURFACE);
    return format ? (int)format->id : -1;
}

static void bytes_come_before_names(void **state)
{
    (void)state;
    static const struct {
        const char *path, *text;
        int id;
    } files[] = {
        {"a.vtk", "hello", FORMAT_OTHER},
        {"folder/a.PLY", "hello", FORMAT_OTHER},
        {"a.off", "hello", FORMAT_OFF},
        {"a.stl", "hello", FORMAT_STL},
        {"a.stl", "ply\n", FORMAT_PLY},
        {"a.mz3", "hello", FORMAT_OTHER},
        {"a.mz3", "MZ", FORMAT_MZ3},
        {"a.obj", "MZ", FORMAT_OBJ},
        {"a", "MZ", -1}, /* a program */
        {"a", "ply\r\n", FORMAT_PLY},
        {"a", "# vtk DataFile Version 3.0\n", FORMAT_VTK},
        {"a", "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">", FORMAT_VTP},
        {"a.obj", "<GIFTI>", FORMAT_GIFTI},
        {"folder/a.OBJ.gz", "v 0 0 0", FORMAT_OBJ},
        {"a.nii.gz", "hello", -1},
        {"a.gii", "hello", -1},
        {".obj", "hello", -1},
        {"", "hello", -1},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        assert_int_equal(id_of(files[i].path, files[i].text), files[i].id);
    }
}

TEST_GROUP(mesh_foreign)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_of_many_objects_may_be_one_surface),
        cmocka_unit_test(the_caller_may_know_the_space_better),
        cmocka_unit_test(mesh_file_read_leads_here),
        cmocka_unit_test(what_we_write_is_read),
        cmocka_unit_test(one_bad_file_among_many_is_named),
        cmocka_unit_test(real_files_are_read),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(bytes_come_before_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
