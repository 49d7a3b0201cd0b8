/* SPDX-License-Identifier: BSD-3-Clause */
/* Where FreeSurfer's surfaces lie; tests/corpus/freesurfer/ and annot/ have the files. */
#include "loaders/surfaces/freesurfer_surface.h"

#include "base/geometry/math3.h"
#include "test.h"

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

TEST_GROUP(freesurfer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_general_form_agrees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
