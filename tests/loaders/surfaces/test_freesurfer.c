/* SPDX-License-Identifier: BSD-3-Clause */
/* Where FreeSurfer's surfaces lie; tests/corpus/freesurfer/ and annot/ have the files. */
#include "loaders/surfaces/parts.h"

#include "base/geometry/math3.h"
#include "builders/nifti_builder.h"
#include "sources/source.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* Norig inv(Torig) as FreeSurfer's own documentation has it, for a volume of any size and spacing. */
static void the_general_form_agrees(void **state)
{
    (void)state;
    const double axes[9] = {-0.8, 0.6, 0, 0, 0, -1, 0.6, 0.8, 0};
    const double centre[3] = {3, -4, 5};
    const double size[3] = {176, 256, 240};
    const double step[3] = {1.2, 0.9, 1};
    double world[16];
    double norig[16];
    double torig[16] = {-step[0], 0, 0, 0, 0, 0, -step[1], 0, 0, step[2], 0, 0};
    double half[3];
    mat4_identity(norig);
    torig[15] = 1;
    for (int i = 0; i < 3; i++) {
        vec3_scale(norig + 4 * i, axes + 3 * i, step[i]);
        half[i] = size[i] / 2;
    }
    mat4_direction(norig + 12, norig, half);
    vec3_sub(norig + 12, centre, norig + 12);
    mat4_direction(torig + 12, torig, half);
    vec3_scale(torig + 12, torig + 12, -1);
    assert_true(mat4_invert_affine(torig, torig));
    mat4_multiply(norig, norig, torig);
    assert_true(freesurfer_world_from_surface(world, axes, centre));
    for (int i = 0; i < 16; i++) {
        assert_near(world[i], norig[i], 1e-12);
    }
}

/* Other readers get such a file first. */
static void another_first_byte_is_refused(void **state)
{
    (void)state;
    static const uint8_t bytes[] = {0x7f, 0xff, 0xfe, '\n', '\n', 0, 0, 0, 4, 0, 0, 0, 4};
    struct mesh mesh = {0};
    struct job job = {0};
    struct reader r = reader_of(&job, (struct text){(const char *)bytes, sizeof bytes});
    freesurfer_surface_read(&r, &mesh, false);
    assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "must begin with the bytes ff ff fe"));
}

enum { VERTICES = 50, TRIANGLES = 48 };

/* A fan with a volume geometry. */
static void make_surface(struct buffer *out)
{
    buffer_append(out,
                  "\xff\xff\xfe"
                  "by hand\n\n",
                  12);
    append_ordered(out, VERTICES, 4, true);
    append_ordered(out, TRIANGLES, 4, true);
    for (size_t i = 0; i < 3 * VERTICES; i++) {
        append_float(out, (double)i, true);
    }
    for (size_t i = 0; i < TRIANGLES; i++) {
        append_ordered(out, 0, 4, true);
        append_ordered(out, i + 1, 4, true);
        append_ordered(out, i + 2, 4, true);
    }
    append_ordered(out, 2, 4, true);
    append_ordered(out, 0, 4, true);
    append_ordered(out, 20, 4, true);
    buffer_text(out, "valid = 1  # volume info valid\nfilename = a.mgz\nvolume = 256 256 256\nvoxelsize = 1 1 1\n"
                     "xras = -1 0 0\nyras = 0 0 -1\nzras = 0 1 0\ncras = 1 2 3\n");
}

static conus_status read_surface(void *path)
{
    struct job job = {0};
    struct mesh mesh = {0};
    struct reader r = source_reader(&job, source_open(&job, path));
    freesurfer_surface_read(&r, &mesh, false);
    if (job_ok(&job)) {
        assert_int_equal(mesh.vertex_count, VERTICES);
        assert_int_equal(mesh.triangle_count, TRIANGLES);
        assert_near(mesh.positions[3 * VERTICES - 3], 3 * VERTICES - 3 + 1, 0);
        assert_near(mesh.positions[3 * VERTICES - 1], 3 * VERTICES - 1 + 3, 0);
        assert_int_equal(mesh.triangles[3 * TRIANGLES - 1], TRIANGLES + 1);
        assert_int_equal(job.notes.count, 1);
        assert_non_null(strstr(job.notes.lines[0], "(c_ras 1, 2, 3)"));
    }
    mesh_finish(&mesh);
    return job_close(&job, NULL, NULL);
}

/* A file is never held whole. Where it ends early within what its header announces, it is refused. */
static void surfaces_are_read_from_files(void **state)
{
    (void)state;
    struct buffer bytes = {0};
    make_surface(&bytes);
    for (int packed = 0; packed < 2; packed++) {
        char path[512];
        snprintf(path, sizeof path, "%s", (packed ? write_packed : write_bytes)("fan.pial", &bytes));
        assert_ok(read_surface(path));
        test_every_allocation(read_surface, path);
        assert_true(test_every_primitive(read_surface, path) > 10);
        for (size_t size = 0; size < 12 + 8 + 12 * (VERTICES + TRIANGLES); size += packed ? 7 : 1) {
            const struct buffer part = {.data = bytes.data, .size = size};
            snprintf(path, sizeof path, "%s", (packed ? write_packed : write_bytes)("part.pial", &part));
            assert_fails(read_surface(path), CONUS_ERROR_DATA);
        }
    }
    buffer_finish(&bytes);
}

TEST_GROUP(freesurfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_general_form_agrees),
        cmocka_unit_test(another_first_byte_is_refused),
        cmocka_unit_test(surfaces_are_read_from_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
