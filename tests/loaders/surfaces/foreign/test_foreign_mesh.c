/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons, strips, pieces, objects and spaces of mesh files become triangles in one space. */
#include "base/buffer.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

#define VTK_POINTS "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 3 0 0 0 3 0 0 0 3\n"

static conus_status parse_obj(struct foreign_mesh *out, const uint8_t *data, size_t size)
{
    return obj_parse(out, NULL, data, size);
}

/* An L in both directions and from another corner, a quadrilateral, an M, and corners in a line. The L has the area 3
 * and 4 triangles, whichever way it is cut: no part is counted twice. The M, a square of 16 without a notch of 6, has
 * its best ear at (0, 0), but the tip of the notch lies in it. */
static void polygons_become_triangles(void **state)
{
    (void)state;
    static const char text[] =
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 3 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\n%s\n";
    static const struct {
        const char *face;
        size_t triangles;
        double area, signed_area;
    } cases[] = {{"f 1 2 3 4 5 6", 4, 3, 3}, {"f 6 5 4 3 2 1", 4, 3, -3}, {"f 1 2 3 6", 2, 3, 3},
                 {"f 4 5 6 1 2 3", 4, 3, 3}, {"f 1 8 9 3 10", 3, 10, 10}, {"f 1 2 7", 1, 0, 0},
                 {"f 1 2 7 2", 2, 0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char file[256];
        struct foreign_mesh mesh = {0};
        double area = 0;
        double signed_area = 0;
        int size = snprintf(file, sizeof file, text, cases[i].face);
        assert_ok(parse_obj(&mesh, (const uint8_t *)file, (size_t)size));
        assert_int_equal(mesh.triangle_count, cases[i].triangles);
        for (size_t t = 0; t < mesh.triangle_count; t++) {
            const float *a = &mesh.positions[3 * (size_t)mesh.triangles[3 * t]];
            const float *b = &mesh.positions[3 * (size_t)mesh.triangles[3 * t + 1]];
            const float *c = &mesh.positions[3 * (size_t)mesh.triangles[3 * t + 2]];
            double part = (double)((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
            signed_area += part;
            area += part < 0 ? -part : part;
        }
        assert_near(area, cases[i].area, 1e-12);
        assert_near(signed_area, cases[i].signed_area, 1e-12);
        foreign_mesh_finish(&mesh);
    }
}

/* A regular polygon of 1024 corners is cut, one of a million is not. */
static void large_polygons_have_a_limit(void **state)
{
    (void)state;
    static const size_t sizes[] = {1024, 1025, 1000000};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct buffer file = {0};
        struct foreign_mesh mesh = {0};
        buffer_text(&file, "v 0 0 0\nv 9 0 0\n");
        buffer_text(&file, "v 0 9 0\nf");
        for (size_t k = 0; k < sizes[i]; k++) {
            buffer_format(&file, " %zu", k % 3 + 1);
        }
        conus_status status = parse_obj(&mesh, (const uint8_t *)file.data, file.size);
        assert_int_equal(status, i ? CONUS_ERROR_UNSUPPORTED : CONUS_OK);
        if (!i) {
            assert_int_equal(mesh.triangle_count, 1022);
        }
        foreign_mesh_finish(&mesh);
        buffer_finish(&file);
    }
}

/* Every second triangle of a strip is turned, so that all face one way. */
static void strips_become_triangles(void **state)
{
    (void)state;
    static const char text[] = VTK_POINTS "TRIANGLE_STRIPS 2 10\n6 0 2 1 3 0 2\n2 0 1\n";
    static const uint32_t wanted[12] = {0, 2, 1, 1, 2, 3, 1, 3, 0, 0, 3, 2};
    struct foreign_mesh mesh = {0};
    assert_ok(vtk_parse(&mesh, (const uint8_t *)text, sizeof text - 1));
    assert_int_equal(mesh.triangle_count, 4);
    assert_memory_equal(mesh.triangles, wanted, sizeof wanted);
    foreign_mesh_finish(&mesh);
}

/* The vertices of the second piece follow those of the first. */
static void pieces_follow_each_other(void **state)
{
    (void)state;
#define PIECE(z)                                                                                                       \
    "<Piece NumberOfPoints=\"3\" NumberOfStrips=\"1\"><Points><DataArray type=\"Float64\" "                            \
    "NumberOfComponents=\"3\" format=\"ascii\">0 0 " z " 1 0 " z " 0 1 " z "</DataArray></Points><Strips>"             \
    "<DataArray type=\"UInt8\" Name=\"offsets\" format=\"ascii\">3</DataArray>"                                        \
    "<DataArray type=\"Int16\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray></Strips></Piece>"
    static const char text[] = "<VTKFile type=\"PolyData\"><PolyData>" PIECE("0") PIECE("5") "</PolyData></VTKFile>";
    static const uint32_t wanted[6] = {0, 1, 2, 3, 4, 5};
    struct foreign_mesh mesh = {0};
    assert_ok(vtp_parse(&mesh, (const uint8_t *)text, sizeof text - 1, 1 << 20));
    assert_int_equal(mesh.vertex_count, 6);
    assert_memory_equal(mesh.triangles, wanted, sizeof wanted);
    assert_true(mesh.positions[17] == 5);
    foreign_mesh_finish(&mesh);
}

static void faces_below_three_corners_are_flat(void **state)
{
    (void)state;
    static const char text[] = "OFF\n3 4 0\n0 0 0\n1 0 0\n0 1 0\n0\n1 2\n2 1 2\n3 0 1 2\n";
    static const uint32_t wanted[9] = {2, 2, 2, 1, 2, 2, 0, 1, 2};
    struct foreign_mesh mesh = {0};
    assert_ok(off_parse(&mesh, (const uint8_t *)text, sizeof text - 1));
    assert_int_equal(mesh.triangle_count, 3);
    assert_memory_equal(mesh.triangles, wanted, sizeof wanted);
    foreign_mesh_finish(&mesh);
}

/* A negative index counts back from the vertices so far, not from the last one of the file. */
static void indices_count_back_from_their_line(void **state)
{
    (void)state;
    static const char text[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\nf 1 -2 6\n";
    static const uint32_t wanted[9] = {0, 1, 2, 3, 4, 5, 0, 4, 5};
    struct foreign_mesh mesh = {0};
    assert_ok(parse_obj(&mesh, (const uint8_t *)text, sizeof text - 1));
    assert_int_equal(mesh.triangle_count, 3);
    assert_memory_equal(mesh.triangles, wanted, sizeof wanted);
    foreign_mesh_finish(&mesh);
}

static void objects_are_told_apart(void **state)
{
    (void)state;
    static const char text[] = "o b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3 4\no\nf 1 2 3\no a\no b \nf 1 2 4\n";
    static const uint32_t owners[4] = {0, 0, 1, 0};
    struct foreign_mesh mesh = {0};
    struct obj_objects objects = {0};
    assert_ok(obj_parse(&mesh, &objects, (const uint8_t *)text, sizeof text - 1));
    assert_int_equal(objects.count, 2);
    assert_true(text_equal(objects.names[0], "b"));
    assert_int_equal(objects.names[1].size, 0);
    assert_int_equal(mesh.triangle_count, 4);
    assert_memory_equal(objects.owners, owners, sizeof owners);
    obj_objects_finish(&objects);
    foreign_mesh_finish(&mesh);
}

static void the_space_is_found(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum mesh_space space;
    } cases[] = {{"", MESH_SPACE_UNSTATED},           {"SPACE=RAS", MESH_SPACE_RAS},
                 {"x SPACE = \tLPS", MESH_SPACE_LPS}, {"SPACELPS", MESH_SPACE_UNSTATED},
                 {"SPACE=SPACE=LPS", MESH_SPACE_LPS}, {"SPACE=ras", MESH_SPACE_RAS},
                 {"space=LPS", MESH_SPACE_LPS},       {"SPACE=", MESH_SPACE_UNSTATED},
                 {"SPACE=LPSX", MESH_SPACE_UNSTATED}, {"NOSPACE=LPS", MESH_SPACE_UNSTATED},
                 {"SPACE=LP", MESH_SPACE_UNSTATED},   {"x;Space=lps;", MESH_SPACE_LPS}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(foreign_space_in(text_from(cases[i].text)), cases[i].space);
    }
}

TEST_GROUP(foreign_mesh)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polygons_become_triangles),
        cmocka_unit_test(large_polygons_have_a_limit),
        cmocka_unit_test(strips_become_triangles),
        cmocka_unit_test(pieces_follow_each_other),
        cmocka_unit_test(faces_below_three_corners_are_flat),
        cmocka_unit_test(indices_count_back_from_their_line),
        cmocka_unit_test(objects_are_told_apart),
        cmocka_unit_test(the_space_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
