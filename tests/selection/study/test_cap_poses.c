/* SPDX-License-Identifier: BSD-3-Clause */
/* Devices at positions of caps (Eq. 35), and no memory. tests/python/test_positions.py has an oracle. */
#include "conus/own.h"
#include "test.h"

#include <math.h>

/* At a point on top of the head the handle of 0 degrees points back, of 90 to the left. */
static void handles_point_backwards_and_to_the_side(void **state)
{
    (void)state;
    conus_place place = {.kind = CONUS_PLACE_POSITION, .name = "Cz", .point = {1, 2, 90}, .outward = {0, 0, 1}};
    conus_position_options options = {.off = 7, .has_handle = true};
    conus_pose pose;
    assert_ok(conus_position_pose(&pose, &place, &options));
    const double *m = pose.world_from_device;
    assert_near(m[14], 97, 1e-12);
    assert_near(m[8 + 2], 1, 1e-12); /* it points along -z, down */
    assert_near(m[4 + 1], 1, 1e-12); /* -y is backwards */
    options.handle = 90;
    assert_ok(conus_position_pose(&pose, &place, &options));
    assert_near(m[4 + 0], 1, 1e-12); /* -y is to the left */
    place.name = "C4";
    assert_ok(conus_position_pose(&pose, &place, &options));
    assert_near(m[4 + 0], -1, 1e-12);
    place.outward[2] = 0;
    assert_fails(conus_position_pose(&pose, &place, &options), CONUS_ERROR_ARGUMENT);
    place.outward[2] = 1;
    options.off = NAN;
    assert_fails(conus_position_pose(&pose, &place, &options), CONUS_ERROR_ARGUMENT);
}

static conus_status ask(void *data)
{
    static const char *const names[] = {"C3", "T4", "F9"};
    conus_table *table = NULL;
    (void)data;
    conus_status status = conus_positions(&table, names, 3, NULL);
    conus_table_destroy(table);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    assert_ok(ask(NULL));
    test_every_allocation(ask, NULL);
}

TEST_GROUP(cap_poses)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(handles_point_backwards_and_to_the_side),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
