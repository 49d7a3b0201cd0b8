/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons become triangles; tests/corpus/foreign/ has strips, pieces, objects and spaces. */
#include "base/buffer.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"
#include "test.h"

#include <stdio.h>

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

/* Other readers get such files first. */
static void other_files_are_refused(void **state)
{
    (void)state;
    static const char binary[] = "v 0 0 0\0\377";
    struct foreign_mesh mesh = {0};
    assert_fails(parse_obj(&mesh, (const uint8_t *)binary, sizeof binary), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "content: binary data, an OBJ file is text");
    assert_fails(ply_parse(&mesh, (const uint8_t *)"plough\n", 7), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "header: a PLY file begins with a line \"ply\"");
}

TEST_GROUP(foreign_mesh)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polygons_become_triangles),
        cmocka_unit_test(large_polygons_have_a_limit),
        cmocka_unit_test(other_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
