/* SPDX-License-Identifier: BSD-3-Clause */
/* Mesh files of other programs: space, objects, notes, and files that break other readers. */
#include "base/buffer.h"
#include "base/files/file.h"
#include "builders/nifti_builder.h"
#include "loaders/surfaces/foreign/mesh_foreign.h"
#include "loaders/surfaces/mesh_file.h"
#include "loaders/surfaces/mesh_format.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *write_text(const char *name, const char *text, size_t size)
{
    const char *path = test_scratch(name);
    assert_ok(file_write_soon(path, text, size));
    return path;
}

/* The unit tetrahedron scaled by 3, in every format: volume 4.5, centroid 0.75 in each of x, y and z. */
static const char legacy[] = "# vtk DataFile Version 3.0\nmade; SPACE=%s\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
                             "0 0 0 3 0 0 0 3 0 0 0 3\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
static const char legacy51[] = "# vtk DataFile Version 5.1\nmade\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
                               "0 0 0 3 0 0 0 3 0 0 0 3\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\n"
                               "CONNECTIVITY vtktypeint64\n0 2 1 0 1 3 0 3 2 1 2 3\n";
static const char strips[] = "# vtk DataFile Version 3.0\nmade\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
                             "0 0 0 3 0 0 0 3 0 0 0 3\nTRIANGLE_STRIPS 1 7\n6 0 2 1 3 0 2\n";
static const char quads[] = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 0 0 3\nv 3 0 3\nv 3 3 3\nv 0 3 3\n"
                            "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
static const char ply[] = "ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty float x\n"
                          "property float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\n"
                          "end_header\n0 0 0\n3 0 0\n0 3 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
static const char stl[] =
    "solid SPACE=RAS\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 3 0\nvertex 3 0 0\nendloop\nendfacet\n"
    "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 0 0 3\nendloop\nendfacet\n"
    "facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 3\nvertex 0 3 0\nendloop\nendfacet\n"
    "facet normal 1 1 1\nouter loop\nvertex 3 0 0\nvertex 0 3 0\nvertex 0 0 3\nendloop\nendfacet\nendsolid\n";

static void read_one(struct mesh *mesh, const char *path, const struct mesh_foreign_options *options,
                     struct notes *notes)
{
    const char *const paths[] = {path};
    if (mesh_foreign_read(mesh, paths, 1, options, notes)) {
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

static void good_files_are_read_and_their_space_is_honoured(void **state)
{
    (void)state;
    char ras[1024];
    char lps[1024];
    snprintf(ras, sizeof ras, legacy, "RAS");
    snprintf(lps, sizeof lps, legacy, "LPS");
    const struct {
        const char *name, *text;
        double volume, at, up;
        size_t notes;
    } cases[] = {
        {"ras.vtk", ras, 4.5, 0.75, 0.75, 0},      {"lps.vtk", lps, 4.5, -0.75, 0.75, 0},
        {"new.vtk", legacy51, 4.5, 0.75, 0.75, 1}, {"strips.vtk", strips, 4.5, 0.75, 0.75, 1},
        {"cube.obj", quads, 27, 1.5, 1.5, 1},      {"lps.ply", ply, 4.5, -0.75, 0.75, 0},
        {"ras.stl", stl, 4.5, 0.75, 0.75, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct mesh mesh;
        struct notes notes = {0};
        read_one(&mesh, write_text(cases[i].name, cases[i].text, strlen(cases[i].text)), NULL, &notes);
        if (notes.count != cases[i].notes || (notes.count && !strstr(notes.lines[0], "does not state its space"))) {
            fail_msg("%s: %zu notes, %s", cases[i].name, notes.count, notes.count ? notes.lines[0] : "");
        }
        check_shape(&mesh, cases[i].volume, cases[i].at, cases[i].up);
        notes_finish(&notes);
    }
}

static void refuse(const char *name, const char *text, size_t size, const char *part)
{
    const char *const paths[] = {write_text(name, text, size)};
    struct mesh mesh;
    struct notes notes = {0};
    if (mesh_foreign_read(&mesh, paths, 1, NULL, &notes) == CONUS_OK) {
        fail_msg("%s was read", paths[0]);
    }
    notes_finish(&notes);
    if (strncmp(conus_message(), paths[0], strlen(paths[0])) != 0 || !strstr(conus_message(), part)) {
        fail_msg("\"%s\" does not begin with %s or does not say \"%s\"", conus_message(), paths[0], part);
    }
}

/* Files that other readers accept, too: the count right behind the keyword, Blender's line that is no comment, and
 * packed files that are named so. The shapes are the cube of `quads` and the tetrahedron. */
static void sloppy_and_packed_files_are_read(void **state)
{
    (void)state;
    static const char off[] = "\t   OFF8 6 12 # or nah\n0 0 0\n3 0 0\n3 3 0\n0 3 0\n0 0 3\n3 0 3\n3 3 3\n0 3 3\n"
                              "4 0 3 2 1 1.0 0.0 0.0 0.75\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    char blender[512];
    struct buffer packed = {0};
    const char *at = strstr(ply, "comment SPACE=LPS\n");
    snprintf(blender, sizeof blender, "%.*sCreated by Blender3D 247 - www.blender.org, source file: \n%s",
             (int)(at - ply), ply, at);
    append_gzip(&packed, quads, strlen(quads));
    const struct {
        const char *name, *data;
        size_t size;
        double volume, at, up;
    } cases[] = {{"cube.off", off, strlen(off), 27, 1.5, 1.5},
                 {"blender.ply", blender, strlen(blender), 4.5, -0.75, 0.75},
                 {"cube.obj.gz", packed.data, packed.size, 27, 1.5, 1.5}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct mesh mesh;
        struct notes notes = {0};
        read_one(&mesh, write_text(cases[i].name, cases[i].data, cases[i].size), NULL, &notes);
        check_shape(&mesh, cases[i].volume, cases[i].at, cases[i].up);
        notes_finish(&notes);
    }
    refuse("x.off", "OFFx 6 12\n", 10, "header: \"OFFx\", allowed are OFF");
    refuse("x.off", "OFF8.5 6 12\n", 12, "header: \"OFF8.5\"");
    refuse("mni.obj.gz", "P 0.3 0.3 0.4 10 1 4\n 0 0 0\n", 29, "an MNI object file, not Wavefront's OBJ");
    buffer_finish(&packed);
}

/* A file of three tetrahedra: one before the first object, "left", and "right side" in two pieces. The sizes are 3, 6
 * and 1, with the volumes 27 / 6, 216 / 6 and 1 / 6; "right side" has the four faces of the third in two lots. */
static const char objects[] = "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
                              "o left\nv 10 0 0\nv 16 0 0\nv 10 6 0\nv 10 0 6\n"
                              "g one\nf 5 7 6\nf 5 6 8\ng two\nf 5 8 7\nf 6 7 8\n"
                              "o right side\r\nv 20 0 0\nv 21 0 0\nv 20 1 0\nv 20 0 1\nf 9 11 10\nf 9 10 12\n"
                              "o nothing\no right side \nf 9 12 11\n  f 10 11 12\n";

static void objects_are_areas(void **state)
{
    (void)state;
    static const char *const names[] = {"objects", "left", "right side"};
    static const double volumes[] = {27. / 6, 216. / 6, 1. / 6};
    const char *path = write_text("objects.obj", objects, sizeof objects - 1);
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    assert_int_equal(conus_atlas_note_count(atlas), 1); /* its space is not stated */
    for (uint32_t i = 0; i < 3; i++) {
        const conus_object *object = conus_atlas_object(atlas, i + 1);
        assert_string_equal(object->name, names[i]);
        assert_int_equal(object->label, i + 1);
        assert_int_equal(object->triangles, 4);
        assert_near(object->volume_mm3, volumes[i], 1e-6);
    }
    conus_atlas_destroy(atlas);
}

static conus_status load_objects(void *data)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, data, NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void objects_without_memory_leave_nothing_behind(void **state)
{
    (void)state;
    const char *path = write_text("objects.obj", objects, sizeof objects - 1);
    test_every_allocation(load_objects, (void *)path);
}

/* A request for single files makes one surface of them, since a manifest's entry is one area. */
static void a_file_of_many_objects_may_be_one_surface(void **state)
{
    (void)state;
    struct mesh mesh;
    struct notes notes = {0};
    read_one(&mesh, write_text("objects.obj", objects, sizeof objects - 1), NULL, &notes);
    assert_int_equal(mesh.triangle_count, 12);
    notes_finish(&notes);
    mesh_finish(&mesh);
}

static void the_caller_may_know_the_space_better(void **state)
{
    (void)state;
    const struct mesh_foreign_options lps = {.space = MESH_SPACE_LPS};
    const struct mesh_foreign_options ras = {.space = MESH_SPACE_RAS};
    struct mesh mesh;
    struct notes notes = {0};
    read_one(&mesh, write_text("cube.obj", quads, sizeof quads - 1), &lps, &notes);
    check_shape(&mesh, 27, -1.5, 1.5);
    read_one(&mesh, write_text("lps.ply", ply, sizeof ply - 1), &ras, &notes);
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
        read_one(&back, write_text(name, bytes.data, bytes.size), NULL, &notes);
        assert_int_equal(notes.count, 0);
        assert_int_equal(back.vertex_count, 4);
        assert_int_equal(back.triangle_count, 4);
        check_shape(&back, 3.25 * 3.25 * 3.25 / 6, 3.25 / 4, 3.25 / 4);
        buffer_finish(&bytes);
    }
}

enum { STL_HEADER = 84, STL_SIZE = STL_HEADER + 4 * 50 };

/* The tetrahedron as binary STL: 80 bytes of header, a count, and per triangle a normal, three corners, two bytes. */
static void build_stl(uint8_t out[STL_SIZE])
{
    static const float corners[4][3] = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
    static const int triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    memset(out, 0, STL_SIZE);
    memcpy(out, "SPACE=RAS", 9);
    out[80] = 4;
    for (int i = 0; i < 12; i++) { /* as this machine has floats */
        memcpy(out + STL_HEADER + 50 * (i / 3) + 12 + 12 * (i % 3), corners[triangles[i / 3][i % 3]], 12);
    }
}

static void binary_stl_files_have_the_size_that_they_say(void **state)
{
    (void)state;
    uint8_t bytes[STL_SIZE + 1] = {0};
    struct mesh mesh;
    struct notes notes = {0};
    build_stl(bytes);
    read_one(&mesh, write_text("whole.stl", (const char *)bytes, STL_SIZE), NULL, &notes);
    check_shape(&mesh, 4.5, 0.75, 0.75);
    assert_int_equal(notes.count, 0);
    const size_t sizes[] = {STL_SIZE - 1, STL_SIZE - 50, STL_SIZE - 117, STL_HEADER, STL_HEADER - 1, 5, STL_SIZE + 1};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        refuse("cut.stl", (const char *)bytes, sizes[i], i < 4 ? "a binary STL file of 4 triangles has 284" : "");
    }
    memset(bytes + 80, 0xFF, 4);
    refuse("absurd.stl", (const char *)bytes, STL_SIZE, "4294967295 triangles has 214748364834");
}

/* Three more triangles: one with three equal corners, one with two, one whose corners are in a line. They are left out
 * with a note, and the rest is unchanged. */
static void triangles_without_area_are_counted(void **state)
{
    (void)state;
    static const float flat[3][9] = {
        {0, 0, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0, 3, 0, 0, 3, 0, 0}, {0, 0, 0, 3, 0, 0, 0, 0, 0}};
    uint8_t bytes[STL_SIZE + 150] = {0};
    struct mesh mesh;
    struct notes notes = {0};
    build_stl(bytes);
    bytes[80] = 7;
    for (int i = 0; i < 3; i++) {
        memcpy(bytes + STL_SIZE + 50 * i + 12, flat[i], sizeof flat[i]);
    }
    read_one(&mesh, write_text("flat.stl", (const char *)bytes, sizeof bytes), NULL, &notes);
    assert_int_equal(mesh.triangle_count, 4);
    assert_int_equal(mesh.vertex_count, 4);
    check_shape(&mesh, 4.5, 0.75, 0.75);
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "3 triangles without area were left out"));
    notes_finish(&notes);
}

/* Files cut off at the end of a line or within one; a file that lacks only the last line end is whole. */
static void other_files_that_are_cut_off_are_refused(void **state)
{
    (void)state;
    char vtk[1024];
    int length = snprintf(vtk, sizeof vtk, legacy, "RAS");
    const struct {
        const char *name, *text;
        size_t size;
    } files[] = {{"cut.vtk", vtk, (size_t)length}, {"cut.ply", ply, sizeof ply - 1}, {"cut.stl", stl, sizeof stl - 1}};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        static const size_t missing[] = {3, 9, 30, 60};
        for (size_t k = 0; k < sizeof missing / sizeof missing[0]; k++) {
            refuse(files[i].name, files[i].text, files[i].size - missing[k], "");
        }
    }
}

static void hostile_files_are_one_line(void **state)
{
    (void)state;
    static const char binary_ply[] =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n\0\0\0\0\0\0\0\0";
    static const char claims[] = "ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\nproperty float x\n"
                                 "property float y\nproperty float z\nelement face 2\n"
                                 "property list uchar int vertex_indices\nend_header\n\0\0\0\0\0\0\0\0";
    static const char vtk_claims[] = "# vtk DataFile Version 3.0\nmade\nBINARY\nDATASET POLYDATA\n"
                                     "POINTS 2000000000 float\n\0\0\0\0\0\0\0\0";
    static const char far_index[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999999\n";
    static const char far_ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                  "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                  "end_header\n0 0 0\n3 0 0\n0 3 0\n3 0 2 77\n";
    static const char freesurfer[] = "\xff\xff\xfe"
                                     "created by someone\n\n\0\0\0\4\0\0\0\4";
    static const char mni[] =
        "P 0.3 0.3 0.4 10 1 3\n 0 0 0\n 1 0 0\n 0 1 0\n\n 0 0 1\n 0 0 1\n 0 0 1\n\n 1\n 0 1 1 1 1\n";
    static const char points[] = "v 0 0 0\nv 1 0 0\n";
    static const char lines[] = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 2 "
                                "0 0\nLINES 1 4\n3 0 1 2\n";
    static const char not_a_number[] = "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char signs[] = "v 1-2 3 4\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char indented[] = "v 0 0 0\n  v 1 0 nan\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    refuse("truncated.ply", binary_ply, sizeof binary_ply - 1,
           "header: 4 elements of 12 bytes or more, 8 bytes follow");
    refuse("short.ply", ply, sizeof ply - 40, "header: 4 elements of 6 bytes or more, 17 bytes follow");
    refuse("header.ply", ply, 48, "header: \"element v\", an element has a name and a count");
    refuse("claims.ply", claims, sizeof claims - 1, "element vertex 2000000000");
    refuse("claims.vtk", vtk_claims, sizeof vtk_claims - 1, "POINTS: 2000000000, more than the 15 bytes");
    refuse("far.obj", far_index, sizeof far_index - 1, "line 4: vertex 999999, allowed are 1 to 3");
    refuse("far.ply", far_ply, sizeof far_ply - 1, "face 0: vertex index 77, allowed are 0 to 2");
    refuse("lh.obj", freesurfer, sizeof freesurfer - 1, "content: binary data, an OBJ file is text");
    refuse("mni.obj", mni, sizeof mni - 1, "an MNI object file");
    refuse("empty.obj", "", 0, "the file is empty");
    refuse("empty.ply", "", 0, "the file is empty");
    refuse("words.vtk", "just words\n", 11, "needed is a surface (VTK, VTP, PLY, MZ3, or named as STL, OBJ or OFF)");
    refuse("points.obj", points, sizeof points - 1, "no triangle with an area");
    refuse("lines.vtk", lines, sizeof lines - 1,
           "this is a VTK file of lines (a tractogram), not a surface: give it as --streamlines");
    refuse("nan.obj", not_a_number, sizeof not_a_number - 1, "line 1: \"v 0 0 nan\", a vertex is three numbers");
    /* some readers take 1, -2 and 3 from the first, and from the second the vertex, whatever comes before its v */
    refuse("signs.obj", signs, sizeof signs - 1, "line 1: \"v 1-2 3 4\", a vertex is three numbers");
    refuse("indented.obj", indented, sizeof indented - 1, "line 2: \"  v 1 0 nan\", a vertex is three numbers");
    refuse("header.vtk", legacy51, 60, "line 5: \"POINT\", needed is POINTS, POLYGONS");
    refuse("short.vtk", legacy51, sizeof legacy51 - 30, "line 10: ");
    refuse("bad.vtp", "<VTKFile type=\"PolyData\"><PolyData>", 34, "line 1");
    refuse("words.stl", "solid\nnothing\n", 14, "line 2: \"nothing\", needed is facet or endsolid");
}

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
    assert_true(mesh_foreign_read(meshes, paths, 4, NULL, &notes) != CONUS_OK);
    assert_non_null(strstr(conus_message(), "far.obj: "));
    assert_null(meshes[0].positions);
    notes_finish(&notes);
    assert_ok(mesh_foreign_read(meshes, paths, 2, NULL, &notes));
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
        read_one(&mesh, test_shared(name), NULL, &notes);
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
    conus_status status = mesh_foreign_read(meshes, paths, 2, NULL, &notes);
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

static void names_tell_what_is_foreign(void **state)
{
    (void)state;
    assert_true(mesh_foreign_is("a.vtk"));
    assert_true(mesh_foreign_is("folder/a.PLY"));
    assert_true(mesh_foreign_is("a.off"));
    assert_true(mesh_foreign_is("a.mz3"));
    assert_true(mesh_foreign_is("folder/a.OBJ.gz"));
    assert_false(mesh_foreign_is("a.nii.gz"));
    assert_false(mesh_foreign_is("a.gii"));
    assert_false(mesh_foreign_is(".obj"));
    assert_false(mesh_foreign_is(""));
}

TEST_GROUP(mesh_foreign)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(good_files_are_read_and_their_space_is_honoured),
        cmocka_unit_test(binary_stl_files_have_the_size_that_they_say),
        cmocka_unit_test(triangles_without_area_are_counted),
        cmocka_unit_test(other_files_that_are_cut_off_are_refused),
        cmocka_unit_test(sloppy_and_packed_files_are_read),
        cmocka_unit_test(objects_are_areas),
        cmocka_unit_test(objects_without_memory_leave_nothing_behind),
        cmocka_unit_test(a_file_of_many_objects_may_be_one_surface),
        cmocka_unit_test(the_caller_may_know_the_space_better),
        cmocka_unit_test(mesh_file_read_leads_here),
        cmocka_unit_test(what_we_write_is_read),
        cmocka_unit_test(hostile_files_are_one_line),
        cmocka_unit_test(one_bad_file_among_many_is_named),
        cmocka_unit_test(real_files_are_read),
        cmocka_unit_test(every_failing_allocation),
        cmocka_unit_test(names_tell_what_is_foreign),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
