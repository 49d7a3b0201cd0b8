/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses from directions, quaternions, matrices and rows; LPS and RAS. */
#include "base/geometry/math3.h"
#include "poses/pose_stream.h"
#include "test.h"

#include <string.h>

static const double origin[3] = {1, 2, 3};

static void assert_same_pose(const conus_pose *a, const conus_pose *b)
{
    for (int i = 0; i < 16; i++) {
        assert_near(a->world_from_device[i], b->world_from_device[i], 1e-12);
    }
}

/* Eq. 2: z = -d, x = normalise(up x z), y = z x x; up = +z, or +y where |d_z| > 0.999. */
static void frame_follows_the_direction(void **state)
{
    (void)state;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, origin, (double[]){0, 5, 0}, NULL));
    const double ahead[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 1, 2, 3, 1};
    assert_same_pose(&pose, (const conus_pose *)ahead);
    assert_ok(conus_pose_along(&pose, origin, (double[]){0, 0, -1}, NULL));
    const double down[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1};
    assert_same_pose(&pose, (const conus_pose *)down);
}

/* Eq. 2: superior, (0 0 1), is up while the direction d = (s 0 c) has |c| <= 0.999, and then the device's y axis is the
 * part of it across d, (-c 0 s) for s > 0; beyond, anterior, (0 1 0), is, which is across d already. */
static void up_is_anterior_only_near_the_vertical(void **state)
{
    (void)state;
    static const double cosines[] = {0.5, 0.99, 0.995, 0.9989, 0.9991, 0.9999, -0.995, -0.9989, -0.9991};
    for (size_t i = 0; i < sizeof cosines / sizeof cosines[0]; i++) {
        double c = cosines[i];
        double s = sqrt(1 - c * c);
        conus_pose pose;
        assert_ok(conus_pose_along(&pose, (double[]){1, 2, 3}, (double[]){s, 0, c}, NULL));
        bool near = fabs(c) > 0.999;
        const double wanted[3] = {near ? 0 : -c, near ? 1 : 0, near ? 0 : s};
        for (int k = 0; k < 3; k++) {
            assert_near(pose.world_from_device[4 + k], wanted[k], 1e-12);
        }
    }
}

static void frames_are_rotations(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int k = 0; k < 200; k++) {
        double d[3];
        double up[3];
        conus_pose pose;
        conus_pose again;
        for (int i = 0; i < 3; i++) {
            d[i] = test_random(&seed, -1, 1);
            up[i] = test_random(&seed, -1, 1);
        }
        assert_ok(conus_pose_along(&pose, origin, d, k % 2 ? up : NULL));
        assert_near(mat4_determinant3(pose.world_from_device), 1, 1e-12);
        assert_ok(conus_pose_from_matrix(&again, pose.world_from_device));
        assert_same_pose(&pose, &again);
    }
}

/* Powers of two change no digit of a direction, from the smallest numbers to the largest. */
static void directions_are_of_any_length(void **state)
{
    (void)state;
    static const double direction[3] = {3, 1, 2};
    static const double up[3] = {-1, 5, 2};
    conus_pose wanted;
    assert_ok(conus_pose_along(&wanted, origin, direction, up));
    for (int power = -1074; power <= 1021; power++) {
        double d[3];
        double u[3];
        conus_pose pose;
        for (int i = 0; i < 3; i++) {
            d[i] = ldexp(direction[i], power);
            u[i] = ldexp(up[i], power);
        }
        assert_ok(conus_pose_along(&pose, origin, d, u));
        assert_memory_equal(&pose, &wanted, sizeof pose);
    }
}

static void quaternion_and_matrix_agree(void **state)
{
    (void)state;
    conus_pose pose;
    const double half = sqrt(0.5);
    /* a quarter turn about z, not of length 1 */
    assert_ok(conus_pose_from_quaternion(&pose, origin, (double[]){3 * half, 0, 0, 3 * half}));
    const double turned[16] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1};
    assert_same_pose(&pose, (const conus_pose *)turned);
}

/* 0.99999994 is the float before 1. */
static void a_last_row_may_be_rounded_to_float(void **state)
{
    (void)state;
    conus_pose pose;
    double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 0.99999994};
    assert_ok(conus_pose_from_matrix(&pose, m));
    m[15] = 1;
    assert_same_pose(&pose, (const conus_pose *)m);
    m[15] = 0.99999;
    assert_fails(conus_pose_from_matrix(&pose, m), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "last row 0 0 0 0.99999, allowed is 0 0 0 1"));
}

/* x = (1, 1, 1) / sqrt 3, y = (1, -1, 0) / sqrt 2, z = x cross y = (1, 1, -2) / sqrt 6, with three decimals: x times x
 * is 3 * 0.577^2 = 0.9988. Any rotation is then off by less than 0.00174; what is off by 0.0021 was no rotation. */
static void a_rotation_may_have_three_decimals(void **state)
{
    (void)state;
    conus_pose pose;
    double m[16] = {0.577, 0.577, 0.577, 0, 0.707, -0.707, 0, 0, 0.408, 0.408, -0.816, 0, 1, 2, 3, 1};
    assert_ok(conus_pose_from_matrix(&pose, m));
    for (int i = 0; i < 16; i++) {
        assert_true(fabs(pose.world_from_device[i] - m[i]) < 1e-3);
    }
    assert_true(fabs(pose.world_from_device[8] - 1 / sqrt(6)) < 1e-12); /* 0.408 : 0.408 : -0.816 is 1 : 1 : -2 */
    const double long_x[16] = {sqrt(1.0021), 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1};
    assert_fails(conus_pose_from_matrix(&pose, long_x), CONUS_ERROR_ARGUMENT);
}

static void impossible_poses_are_refused(void **state)
{
    (void)state;
    conus_pose pose;
    const double zero[3] = {0};
    const double nan3[3] = {0, NAN, 0};
    double left[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double scaled[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1};
    assert_fails(conus_pose_along(&pose, origin, zero, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_along(&pose, nan3, origin, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_along(&pose, origin, nan3, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_along(&pose, origin, origin, origin), CONUS_ERROR_ARGUMENT); /* up along the direction */
    assert_fails(conus_pose_along(&pose, origin, origin, zero), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_toward(&pose, origin, origin, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_toward(&pose, origin, nan3, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_from_matrix(&pose, left), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_from_matrix(&pose, scaled), CONUS_ERROR_ARGUMENT);
    left[0] = NAN;
    assert_fails(conus_pose_from_matrix(&pose, left), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_pose_from_quaternion(&pose, origin, (double[]){0, 0, 0, 0}), CONUS_ERROR_ARGUMENT);
}

static conus_pose_list *parse(const char *text, conus_space space)
{
    conus_pose_list *list = NULL;
    assert_ok(pose_list_parse(&list, text_from(text), &(conus_pose_options){.space = space}));
    return list;
}

/* The same pose in the four forms that a table can have, and as a plain matrix. */
static void every_way_gives_the_same_pose(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "query_id\tx\ty\tz\ttx\tty\ttz\nA\t1\t2\t3\t1\t9\t3\n",
        "\xef\xbb\xbfx,y,z,dx,dy,dz,ux,uy,uz\r\n1,2,3,0,2,0,0,0,1\r\n",
        "# a comment\rx\ty\tz\tqw\tqx\tqy\tqz\r1\t2\t3\t0.70710678\t0.70710678\t0\t0\r",
        "m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23,m30,m31,m32,m33\n1,0,0,1,0,0,-1,2,0,1,0,3,0,0,0,1\n",
        "1 0 0 1\n0 0 -1 2\n0 1 0 3\n0 0 0 1\n"};
    conus_pose wanted;
    assert_ok(conus_pose_along(&wanted, origin, (double[]){0, 1, 0}, NULL));
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        conus_pose_list *list = parse(texts[i], CONUS_SPACE_RAS);
        assert_int_equal(conus_pose_list_count(list), 1);
        const conus_pose_row *row = conus_pose_list_row(list, 0);
        assert_null(row->error);
        assert_string_equal(row->id, i ? "1" : "A");
        assert_same_pose(&row->pose, &wanted);
        conus_pose_list_destroy(list);
    }
}

/* A pose written in LPS, with x and y negated, is the same pose. */
static void lps_negates_x_and_y(void **state)
{
    (void)state;
    static const char *const ras[] = {"x,y,z,tx,ty,tz\n1,2,3,4,6,9\n", "x,y,z,dx,dy,dz,ux,uy,uz\n1,2,3,3,4,6,1,1,0\n",
                                      "x,y,z,qw,qx,qy,qz\n1,2,3,0.5,0.5,-0.5,0.5\n"};
    static const char *const lps[] = {"x,y,z,tx,ty,tz\n-1,-2,3,-4,-6,9\n",
                                      "x,y,z,dx,dy,dz,ux,uy,uz\n-1,-2,3,-3,-4,6,-1,-1,0\n",
                                      "x,y,z,qw,qx,qy,qz\n-1,-2,3,-0.5,0.5,0.5,0.5\n"};
    for (size_t i = 0; i < 3; i++) {
        conus_pose_list *a = parse(ras[i], CONUS_SPACE_RAS);
        conus_pose_list *b = parse(lps[i], CONUS_SPACE_LPS);
        assert_same_pose(&conus_pose_list_row(a, 0)->pose, &conus_pose_list_row(b, 0)->pose);
        conus_pose_list_destroy(a);
        conus_pose_list_destroy(b);
    }
}

/* A row states its space, or leaves it to the option; a row of another brain's space is an error. */
static void rows_say_their_space(void **state)
{
    (void)state;
    static const char text[] = "x,y,z,dx,dy,dz,space\n1,2,3,3,4,6,RAS\n-1,-2,3,-3,-4,6,lps\n1,2,3,3,4,6,n/a\n"
                               "-1,-2,3,-3,-4,6,\n1,2,3,3,4,6,MNI152\n";
    conus_pose_list *ras = parse(text, CONUS_SPACE_RAS);
    conus_pose_list *lps = parse(text, CONUS_SPACE_LPS);
    const conus_pose *wanted = &conus_pose_list_row(ras, 0)->pose;
    assert_near(wanted->world_from_device[12], 1, 0);
    assert_same_pose(&conus_pose_list_row(lps, 0)->pose, wanted);
    assert_same_pose(&conus_pose_list_row(ras, 1)->pose, wanted);
    assert_same_pose(&conus_pose_list_row(lps, 1)->pose, wanted);
    assert_same_pose(&conus_pose_list_row(ras, 2)->pose, wanted);
    assert_same_pose(&conus_pose_list_row(lps, 3)->pose, wanted);
    assert_near(conus_pose_list_row(ras, 3)->pose.world_from_device[12], -1, 0);
    assert_non_null(strstr(conus_pose_list_row(ras, 4)->error,
                           "column space: \"MNI152\", allowed are RAS, LPS, ccf, bregma and n/a"));
    conus_pose_list_destroy(ras);
    conus_pose_list_destroy(lps);
}

static void bad_rows_keep_their_place(void **state)
{
    (void)state;
    conus_pose_list *list = parse("query_id\tx\ty\tz\tdx\tdy\tdz\tangle\ttime_s\n"
                                  "good\t0\t0\t0\t0\t1\t0\t5\t1\n"
                                  "nan\tnan\t0\t0\t0\t1\t0\t5\t1\n"
                                  "zero\t0\t0\t0\t0\t0\t0\t5\t1\n"
                                  "\n"
                                  "short\t0\t0\n"
                                  "text\t0\t0\t0\t0\tone\t0\t5\t1\n"
                                  "wide\t0\t0\t0\t0\t1\t0\t180\t1\n"
                                  "hex\t0\t0\t0\t0\t0x1p2\t0\t5\t1\n"
                                  "never\t0\t0\t0\t0\t1\t0\t5\tnan\n"
                                  "line\t0\t0\t0\t0\t1\t0\t0\t1\n",
                                  CONUS_SPACE_RAS);
    assert_int_equal(conus_pose_list_count(list), 9);
    assert_null(conus_pose_list_row(list, 0)->error);
    assert_near(conus_pose_list_row(list, 0)->angle, 5, 0);
    const char *const parts[] = {"column x: \"nan\"", "direction", "3 fields", "\"one\"",
                                 "angle: 180",        "\"0x1p2\"", "\"nan\"",  "180, or n/a for none"};
    const char *const ids[] = {"nan", "zero", "short", "text", "wide", "hex", "never", "line"};
    const size_t lines[] = {3, 4, 6, 7, 8, 9, 10, 11};
    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i + 1);
        assert_non_null(row->error);
        assert_non_null(strstr(row->error, parts[i]));
        assert_string_equal(row->id, ids[i]);
        assert_int_equal(row->line, lines[i]);
    }
    conus_pose_list_destroy(list);
}

static void bad_headers_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"",
                                        "x y zz\n",
                                        "x,y,z,roll\n1,2,3,4\n",
                                        "x,y,z,tx,ty\n",
                                        "x,y,z,tx,ty,tz,dx,dy,dz\n",
                                        "x,x,y,z,tx,ty,tz\n",
                                        "x,y,tx,ty,tz\n",
                                        "x,y,z,qw,qx,qy,qz,ux,uy,uz\n",
                                        "x,y,z,tx,ty,speed\n",
                                        "# x,y,z,tx,ty,tz\n",
                                        "1 2 3 4 5\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        conus_pose_list *list = NULL;
        assert_fails(pose_list_parse(&list, text_from(texts[i]), NULL), CONUS_ERROR_DATA);
        assert_null(list);
    }
}

static conus_status parse_table(void *data)
{
    conus_pose_list *list = NULL;
    conus_status status = pose_list_parse(&list, text_from(data), NULL);
    conus_pose_list_destroy(list);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    char text[] = "x,y,z,tx,ty,tz\n1,2,3,4,5,6\n1,2,3,1,2,3\n";
    test_every_allocation(parse_table, text);
}

TEST_GROUP(pose)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frame_follows_the_direction),
        cmocka_unit_test(frames_are_rotations),
        cmocka_unit_test(directions_are_of_any_length),
        cmocka_unit_test(up_is_anterior_only_near_the_vertical),
        cmocka_unit_test(quaternion_and_matrix_agree),
        cmocka_unit_test(a_last_row_may_be_rounded_to_float),
        cmocka_unit_test(a_rotation_may_have_three_decimals),
        cmocka_unit_test(impossible_poses_are_refused),
        cmocka_unit_test(every_way_gives_the_same_pose),
        cmocka_unit_test(lps_negates_x_and_y),
        cmocka_unit_test(rows_say_their_space),
        cmocka_unit_test(bad_rows_keep_their_place),
        cmocka_unit_test(bad_headers_are_refused),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
