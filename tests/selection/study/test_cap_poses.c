/* SPDX-License-Identifier: BSD-3-Clause */
/* Devices at positions of caps (Eq. 35), and no memory. tests/python/test_positions.py has an oracle. */
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>

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

enum { RINGS = 60, AROUND = 120 };

/* A ball of 90 mm about the origin, as OFF. */
static const char *write_ball(void)
{
    const char *path = test_scratch("ball.off");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "OFF\n%d %d 0\n0 0 90\n0 0 -90\n", 2 + (RINGS - 1) * AROUND, 2 * AROUND * (RINGS - 1));
    for (int i = 1; i < RINGS; i++) {
        for (int k = 0; k < AROUND; k++) {
            const double theta = acos(-1) * i / RINGS;
            const double phi = 2 * acos(-1) * k / AROUND;
            fprintf(file, "%.6f %.6f %.6f\n", 90 * sin(theta) * cos(phi), 90 * sin(theta) * sin(phi), 90 * cos(theta));
        }
    }
    for (int k = 0; k < AROUND; k++) {
        const int next = (k + 1) % AROUND;
        fprintf(file, "3 0 %d %d\n3 1 %d %d\n", 2 + k, 2 + next, 2 + (RINGS - 2) * AROUND + next,
                2 + (RINGS - 2) * AROUND + k);
        for (int i = 0; i + 2 < RINGS; i++) {
            const int a = 2 + i * AROUND + k;
            const int b = 2 + i * AROUND + next;
            fprintf(file, "3 %d %d %d\n3 %d %d %d\n", a, a + AROUND, b + AROUND, a, b + AROUND, b);
        }
    }
    assert_int_equal(fclose(file), 0);
    return path;
}

static const double landmarks[4][3] = {{0, 90, 0}, {0, -90, 0}, {-90, 0, 0}, {90, 0, 0}};

/* With landmarks on the equator Cz is the pole, and C3 36 degrees to the left of it. */
static void a_ball_has_its_positions(void **state)
{
    (void)state;
    static const char *const names[] = {"Cz", "c3", "T4"};
    conus_scalp *scalp = NULL;
    conus_table *table = NULL;
    assert_ok(conus_scalp_load(&scalp, write_ball(), landmarks));
    assert_ok(conus_positions(&table, names, 3, &(conus_position_options){.scalp = scalp, .off = 10}));
    const double *x = conus_table_numbers(table, "x");
    const double *z = conus_table_numbers(table, "z");
    assert_near(x[0], 0, 0.3);
    assert_near(z[0], 100, 0.3);
    assert_near(x[1], -100 * sin(acos(-1) / 5), 0.5); /* 2 / 10 of half a circle from the pole: 36 degrees */
    assert_near(z[1], 100 * cos(acos(-1) / 5), 0.5);
    assert_near(x[2], 100 * cos(acos(-1) / 10), 0.5); /* 9 / 10 of it: 18 degrees above the ear */
    conus_table_destroy(table);
    assert_fails(conus_positions(&table, (const char *const[]){"F9"}, 1, &(conus_position_options){.scalp = scalp}),
                 CONUS_ERROR_ARGUMENT);
    conus_scalp_destroy(scalp);
    conus_scalp_destroy(NULL);
}

static conus_status load(void *path)
{
    conus_scalp *scalp = NULL;
    conus_table *way = NULL;
    conus_status status = conus_scalp_load(&scalp, path, landmarks);
    status =
        status ? status
               : conus_positions(&way, (const char *const[]){"C3>F3:50"}, 1, &(conus_position_options){.scalp = scalp});
    conus_table_destroy(way);
    conus_scalp_destroy(scalp);
    return status;
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
    test_every_allocation(load, (void *)write_ball());
}

TEST_GROUP(cap_poses)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(handles_point_backwards_and_to_the_side),
        cmocka_unit_test(a_ball_has_its_positions),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
