/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons become triangles; tests/corpus/foreign/ has strips, pieces, objects and spaces. */
#include "base/memory.h"
#include "loaders/surfaces/foreign/foreign.h"
#include "loaders/surfaces/foreign/parts.h"
#include "test.h"

#include <stdio.h>

static struct mesh_build build_obj(struct job *job, const char *data, size_t size)
{
    struct mesh_build build = mesh_build_of(job);
    obj_parse(&build.sink, (struct text){data, size});
    return build;
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
        struct job job = {0};
        double area = 0;
        double signed_area = 0;
        int size = snprintf(file, sizeof file, text, cases[i].face);
        const struct mesh_build mesh = build_obj(&job, file, (size_t)size);
        assert_true(job_ok(&job));
        assert_int_equal(mesh.triangles.count, cases[i].triangles);
        for (size_t t = 0; t < mesh.triangles.count; t++) {
            const uint32_t *corners = mesh.triangles.at[t].corners;
            const float *a = mesh.sink.vertices.at[corners[0]].at;
            const float *b = mesh.sink.vertices.at[corners[1]].at;
            const float *c = mesh.sink.vertices.at[corners[2]].at;
            double part = (double)((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
            signed_area += part;
            area += part < 0 ? -part : part;
        }
        assert_near(area, cases[i].area, 1e-12);
        assert_near(signed_area, cases[i].signed_area, 1e-12);
        job_end(&job);
    }
}

/* A regular polygon of 1024 corners is cut, one of a million is not. */
static void large_polygons_have_a_limit(void **state)
{
    (void)state;
    static const size_t sizes[] = {1024, 1025, 1000000};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct buffer file = {0};
        struct job job = {0};
        buffer_text(&file, "v 0 0 0\nv 9 0 0\n");
        buffer_text(&file, "v 0 9 0\nf");
        for (size_t k = 0; k < sizes[i]; k++) {
            buffer_format(&file, " %zu", k % 3 + 1);
        }
        const struct mesh_build mesh = build_obj(&job, file.data, file.size);
        assert_int_equal(job.status, i ? CONUS_ERROR_UNSUPPORTED : CONUS_OK);
        assert_int_equal(mesh.triangles.count, i ? 0 : 1022);
        job_end(&job);
        buffer_finish(&file);
    }
}

/* Other readers get such files first. */
static void other_files_are_refused(void **state)
{
    (void)state;
    static const char binary[] = "v 0 0 0\0\377";
    struct job job = {0};
    (void)build_obj(&job, binary, sizeof binary);
    assert_string_equal(job.message, "content: binary data, an OBJ file is text");
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    struct mesh_build mesh = mesh_build_of(&job);
    ply_parse(&mesh.sink, text_from("plough\n"));
    assert_string_equal(job.message, "header: a PLY file begins with a line \"ply\"");
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
}

TEST_GROUP(mesh_build)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polygons_become_triangles),
        cmocka_unit_test(large_polygons_have_a_limit),
        cmocka_unit_test(other_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
