/* SPDX-License-Identifier: BSD-3-Clause */
/* The planes of Eq. 7. */
#include "base/geometry/math3.h"
#include "render/passes/shapes.h"
#include "test.h"

/* Eq. 7: the paper's 256^3 volume has 362 planes, and 72 of them in the ID pass. */
static void defaults_are_the_papers(void **state)
{
    (void)state;
    assert_int_equal(slices_default((size_t[]){256, 256, 256}), 362);
    assert_int_equal(slices_default((size_t[]){1, 181, 10}), 255);
    assert_int_equal(slices_of_id_pass(0, 0, (size_t[]){256, 256, 256}), 72);
    assert_int_equal(slices_of_id_pass(362, 0, (size_t[]){1, 1, 1}), 72);
    assert_int_equal(slices_of_id_pass(3, 0, (size_t[]){1, 1, 1}), 1);
}

/* Eq. 7: M = floor(F N), at least 1, for F = K/100 and each N: in whole numbers K N / 100. */
static void a_fraction_is_rounded_down_as_decimals_are(void **state)
{
    (void)state;
    const size_t dim[3] = {1, 1, 1};
    for (uint32_t n = 1; n <= 3000; n++) {
        assert_int_equal(slices_of_id_pass(n, 0, dim), n < 5 ? 1 : n / 5);
        for (uint32_t percent = 1; percent <= 100; percent++) {
            uint32_t wanted = n * percent / 100;
            assert_int_equal(slices_of_id_pass(n, percent / 100.0, dim), wanted ? wanted : 1);
        }
    }
    assert_int_equal(slices_of_id_pass(65536, 1e-300, dim), 1);
    assert_int_equal(slices_of_id_pass(UINT32_MAX, 1, dim), UINT32_MAX);
    assert_int_equal(slices_of_id_pass(0, 0.5, (size_t[]){256, 256, 256}), 181);
}

/* Eq. 7: voxels of 2 mm, 10 of them along the axis, seen from outside, from inside and from behind. */
static void planes_share_the_depth_range_evenly(void **state)
{
    (void)state;
    const size_t dim[3] = {10, 4, 4};
    double world_from_voxel[16];
    mat4_identity(world_from_voxel);
    world_from_voxel[0] = 2;
    const double along[3] = {1, 0, 0};
    struct slices outside = slices_over(dim, world_from_voxel, (double[]){-11, 0, 0}, along, 5);
    assert_int_equal(outside.count, 5);
    assert_near(slices_depth(&outside, 0), 12, 1e-12); /* the volume covers depths 10 to 30 */
    assert_near(slices_depth(&outside, 4), 28, 1e-12);
    struct slices inside = slices_over(dim, world_from_voxel, (double[]){9, 0, 0}, along, 2);
    assert_near(slices_depth(&inside, 0), 2.5, 1e-12); /* depths 0 to 10 are in front */
    assert_near(slices_depth(&inside, 1), 7.5, 1e-12);
    struct slices behind = slices_over(dim, world_from_voxel, (double[]){20, 0, 0}, along, 5);
    assert_int_equal(behind.count, 0);
}

/* Eq. 7: along a diagonal the range goes from corner to corner. */
static void a_diagonal_view_covers_the_diagonal(void **state)
{
    (void)state;
    double world_from_voxel[16];
    mat4_identity(world_from_voxel);
    double axis[3] = {1, 1, 1};
    assert_true(vec3_normalise(axis, axis));
    struct slices slices = slices_over((size_t[]){8, 8, 8}, world_from_voxel, (double[]){-100, -100, -100}, axis, 1);
    assert_near(slices.spacing, 8 * sqrt(3), 1e-9);
    assert_near(slices_depth(&slices, 0), 103.5 * sqrt(3), 1e-9);
}

TEST_GROUP(slices)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_the_papers),
        cmocka_unit_test(a_fraction_is_rounded_down_as_decimals_are),
        cmocka_unit_test(planes_share_the_depth_range_evenly),
        cmocka_unit_test(a_diagonal_view_covers_the_diagonal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
