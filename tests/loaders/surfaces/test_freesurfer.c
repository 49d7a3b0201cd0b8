/* SPDX-License-Identifier: BSD-3-Clause */
/* Where FreeSurfer's surfaces lie; tests/corpus/freesurfer/ and annot/ have the files. */
#include "loaders/surfaces/freesurfer_surface.h"

#include "base/geometry/math3.h"
#include "test.h"

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
    struct notes notes = {0};
    assert_fails(freesurfer_surface_parse(&mesh, bytes, sizeof bytes, false, &notes), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "must begin with the bytes ff ff fe"));
}

TEST_GROUP(freesurfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_general_form_agrees),
        cmocka_unit_test(another_first_byte_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
