/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses in the Allen CCF and from bregma: tables, points, and the files of the International Brain Laboratory. Expected
 * positions follow from the frames below by hand. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "pose_checks.h"
#include "poses/pose_stream.h"
#include "poses/rows/pose_row.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The Allen CCF with its corner at the world's origin: x = ML / 1000, y = -AP / 1000, z = -DV / 1000 mm. */
static const conus_frame ccf = {.space = CONUS_SPACE_CCF,
                                .world_from_space = {0, -1e-3, 0, 0, 0, 0, -1e-3, 0, 1e-3, 0, 0, 0, 0, 0, 0, 1},
                                .bregma = {5400, 332, 5739}};
/* Positions from a bregma at AP 5000, DV 300, ML 5500 um in it: x = 5.5 + ML, y = -5 + AP, z = -0.3 + DV mm. */
static const conus_frame other_bregma = {.space = CONUS_SPACE_BREGMA,
                                         .world_from_space = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 5.5, -5, -0.3, 1},
                                         .bregma = {5000, 300, 5500}};
static const conus_pose_options in_ccf = {.frame = &ccf};
static const conus_pose_options from_bregma = {.frame = &other_bregma};

static conus_pose_list *parse(const char *text, const conus_pose_options *options)
{
    return pose_text_parse(text_from(text), options);
}

static void refuse(const char *text, const conus_pose_options *options, const char *part)
{
    pose_text_refuse(text_from(text), options, part);
}

/* Micrometres ML, AP, DV from the laboratory's bregma (AP 5400, DV 332, ML 5739): ML 5739 - 1639 = 4100, AP 5400 + 100
 * = 5500, DV 332 + 468 = 800 in CCF, whatever the bregma of --space is. */
static void ibl_picks_count_from_their_own_bregma(void **state)
{
    (void)state;
    const conus_pose_options *const both[] = {&in_ccf, &from_bregma};
    for (int i = 0; i < 2; i++) {
        conus_pose_list *list = pose_sample_load("ibl-picks.json", both[i]);
        assert_int_equal(conus_pose_list_count(list), 4);
        assert_true(pose_row_of(list, 0, "1")->is_point);
        assert_row_at(conus_pose_list_row(list, 0), 4.1, -5.5, -0.8);
        assert_row_at(pose_row_of(list, 1, "2"), 4.0995, -5.55, -2.10025);
        assert_string_equal(pose_row_of(list, 2, "3")->error, "y: a number is needed, micrometres from bregma");
        assert_non_null(pose_row_of(list, 3, "4")->error);
        conus_pose_list_destroy(list);
    }
}

/* The file states its own bregma: ML 5700, AP 5300, DV 300. */
static void ibl_channels_say_where_bregma_lies(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("ibl-channels.json", &in_ccf);
    assert_int_equal(conus_pose_list_count(list), 3);
    assert_row_at(pose_row_of(list, 0, "channel_0"), 4.061, -5.4, -2.068);
    assert_row_at(pose_row_of(list, 1, "channel_1"), 4.1, -5.39, -0.768);
    assert_non_null(pose_row_of(list, 2, "channel_2")->error);
    conus_pose_list_destroy(list);
}

/* Any channel is one: AP 5400 - 1000, DV 332 + 3000, ML 5739 + 1000 in CCF, of which the world is -AP, -DV, ML. */
static void ibl_channels_begin_anywhere(void **state)
{
    (void)state;
    conus_pose_list *list = parse("{\"channel_47\":{\"x\":1000,\"y\":1000,\"z\":-3000}}", &in_ccf);
    assert_int_equal(conus_pose_list_count(list), 1);
    assert_row_at(pose_row_of(list, 0, "channel_47"), 6.739, -4.4, -3.332);
    conus_pose_list_destroy(list);
}

static void ibl_is_read_strictly(void **state)
{
    (void)state;
    static const char one[] = "{\"xyz_picks\":[[1,2,300]]}";
    const conus_pose_options along = {.frame = &ccf, .axis = CONUS_AXIS_PLUS_Z};
    const conus_pose_options stated = {.frame = &ccf, .format = "ibl"};
    refuse(one, NULL, "space ccf or bregma is needed");
    refuse(one, &along, "no axis (+z)");
    refuse("{\"xyz_picks\":{}}", &in_ccf, "xyz_picks: a list is needed");
    refuse("{\"xyz_picks\":[[0.0016,-0.004,19]]}", &in_ccf, "micrometres are needed");
    refuse("{\"channel_0\":{\"x\":1,\"y\":2,\"z\":300},\"origin\":{\"bregma\":[1,2]}}", &in_ccf,
           "origin.bregma: three");
    refuse("{\"channel_0\":{\"x\":1,\"y\":2,\"z\":300},\"origin\":[]}", &in_ccf, "origin.bregma: three");
    refuse("{\"a\":1}", &stated, "not positions of IBL");
    refuse("[1]", &stated, "not positions of IBL");
    refuse("{\"a\":1}", &in_ccf, "JSON of no known program");
    refuse("{\"channel_map\":{}, \"channel_7\":3}", &in_ccf, "JSON of no known program");
    refuse("{\"atlasName\":\"x\"}", NULL, "a scene of Pinpoint");
    refuse("{\"markups\":[]}", &in_ccf, "format markups are not in space ccf");
    refuse("{\"xyz_picks\":[[1,2,300]],\"channel_1\":{\"x\":1,\"y\":2,\"z\":300}}", &in_ccf,
           "positions of IBL are one of them");
    conus_pose_list *list = parse("{\"xyz_picks\":[]}", &in_ccf);
    assert_int_equal(conus_pose_list_count(list), 0);
    conus_pose_list_destroy(list);
}

/* Columns may have the axes' names, in any order; the unit of each row counts. */
static void tables_are_in_ccf_or_from_bregma(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("ccf.csv", &in_ccf);
    const conus_pose_row *row = pose_row_of(list, 0, "a");
    assert_row_at(row, 5.739, -5.4, 1);
    assert_near(row->pose.world_from_device[10], 1, 1e-12); /* it looks down: -z of the device is -z of the world */
    assert_non_null(strstr(pose_row_of(list, 1, "b")->error, "not mm"));
    assert_non_null(strstr(pose_row_of(list, 2, "c")->error, "toward"));
    conus_pose_list_destroy(list);
    list = parse("x,y,z,dx,dy,dz\n-3.4,2,-2.5,0,1,0\n-3400,2000,-2500,0,1,0\n", &from_bregma); /* AP, ML, DV */
    assert_row_at(conus_pose_list_row(list, 0), 7.5, -8.4, -2.8);
    assert_near(conus_pose_list_row(list, 0)->pose.world_from_device[8], -1, 1e-12); /* it looks along ML: +x */
    assert_non_null(strstr(conus_pose_list_row(list, 1)->error, "not micrometres"));
    conus_pose_list_destroy(list);
    list = parse("DV\tml\tAP\tddv\tdml\tdap\tudv\tuml\tuap\n1\t2\t3\t-1\t0\t0\t0\t0\t1\n", &from_bregma);
    assert_row_at(conus_pose_list_row(list, 0), 7.5, -2, 0.7);
    assert_near(conus_pose_list_row(list, 0)->pose.world_from_device[5], 1, 1e-12); /* +y up: AP is +y */
    conus_pose_list_destroy(list);
    list = parse("5400 332 5739 bregma\n", &in_ccf);
    assert_row_at(pose_row_of(list, 0, "bregma"), 5.739, -5.4, -0.332);
    conus_pose_list_destroy(list);
}

/* A column may state the space of each row. */
static void a_row_of_another_space_is_refused(void **state)
{
    (void)state;
    conus_pose_list *list = parse("x,y,z,dx,dy,dz,space\n1,2,300,0,1,0,CCF\n1,2,3,0,1,0,bregma\n1,2,300,0,1,0,MNI\n"
                                  "1,2,300,0,1,0,n/a\n1,2,300,0,1,0,ras\n",
                                  &in_ccf);
    static const char *const parts[] = {NULL, "column space: \"bregma\", the table is read in ccf",
                                        "column space: \"MNI\", allowed are RAS, LPS, ccf", NULL,
                                        "column space: \"ras\""};
    for (size_t i = 0; i < 5; i++) {
        const char *error = conus_pose_list_row(list, i)->error;
        assert_int_equal(!error, !parts[i]);
        assert_true(!error || strstr(error, parts[i]));
    }
    conus_pose_list_destroy(list);
    list = parse("x,y,z,dx,dy,dz,space\n1,2,3,0,1,0,lps\n1,2,3,0,1,0,ccf\n", NULL);
    assert_null(conus_pose_list_row(list, 0)->error);
    assert_non_null(strstr(conus_pose_list_row(list, 1)->error, "column space: \"ccf\", the table is read in ras"));
    conus_pose_list_destroy(list);
}

static void other_formats_are_not_in_ccf(void **state)
{
    (void)state;
    const conus_pose_options no_frame = {.space = CONUS_SPACE_CCF};
    conus_pose_list *list = NULL;
    refuse("qw,qx,qy,qz,x,y,z\n1,0,0,0,5400,332,5739\n", &in_ccf, "rotations");
    refuse("1 0 0 5400 0 1 0 332 0 0 1 5739 0 0 0 1\n", &in_ccf, "format matrix are not in space ccf");
    refuse("ap,dv,ml,ap,dx,dy,dz\n", &in_ccf, "\"ap\" twice");
    refuse("ap,dv,ml,dx,dy,dz\n", NULL, "x y z, the positions, are missing");
    assert_fails(conus_pose_list_load(&list, pose_sample("brainsight.txt"), &from_bregma), CONUS_ERROR_DATA);
    assert_fails(conus_pose_list_load(&list, pose_sample("lines.mrk.json"), &in_ccf), CONUS_ERROR_DATA);
    assert_fails(pose_list_parse(&list, text_from("1 2 3\n"), &no_frame), CONUS_ERROR_UNSUPPORTED);
}

static const char *const samples[] = {"ibl-picks.json", "ibl-channels.json", "ccf.csv"};

/* A file that is cut off is refused or gives the first of its rows. */
static void every_prefix_is_refused_or_shorter(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof samples / sizeof samples[0]; k++) {
        struct bytes bytes = {0};
        conus_pose_list *whole = pose_sample_load(samples[k], &in_ccf);
        assert_ok(file_read(&bytes, pose_sample(samples[k]), 1 << 20));
        for (size_t size = 0; size < bytes.size; size++) {
            conus_pose_list *list = NULL;
            char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
            memcpy(exact, bytes.data, size);
            if (pose_list_parse(&list, (struct text){exact, size}, &in_ccf) == CONUS_OK) {
                assert_true(conus_pose_list_count(list) <= conus_pose_list_count(whole));
            }
            conus_pose_list_destroy(list);
            free(exact);
        }
        conus_pose_list_destroy(whole);
        bytes_finish(&bytes);
    }
}

static conus_status load_sample(void *path)
{
    conus_pose_list *list = NULL;
    conus_status status = conus_pose_list_load(&list, path, &in_ccf);
    conus_pose_list_destroy(list);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof samples / sizeof samples[0]; k++) {
        char path[4096];
        snprintf(path, sizeof path, "%s", pose_sample(samples[k]));
        test_every_allocation(load_sample, path);
    }
}

/* Where the device goes, in the world. */
static void assert_axis(const conus_pose *pose, double x, double y, double z)
{
    assert_near(-pose->world_from_device[8], x, 1e-12);
    assert_near(-pose->world_from_device[9], y, 1e-12);
    assert_near(-pose->world_from_device[10], z, 1e-12);
}

/* A folder of BrainGlobe ("asr"): the world is a mirror image of bregma's space. */
static const conus_frame mirrored_bregma = {.space = CONUS_SPACE_BREGMA,
                                            .world_from_space = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5.7, 0, 0, 1},
                                            .bregma = {5400, 332, 5739}};

/* Eq. 24: by 45 degrees to the side the tip is as far lateral as it is deep, whichever space states it: in all frames
 * here the world's y is anterior and z is up, and x is to the right or, mirrored, to the left. */
static void tilts_lead_lateral_and_anterior(void **state)
{
    (void)state;
    const double quarter = 0.78539816339744831;
    const double half = sqrt(0.5);
    const conus_frame ras = {.world_from_space = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    const conus_frame lps = {.space = CONUS_SPACE_LPS,
                             .world_from_space = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    const struct {
        const conus_frame *frame;
        double midline, right; /* x of the midline, and the sign of x towards the right */
    } cases[] = {{&ras, 0, 1}, {&lps, 0, 1}, {&ccf, 5.739, 1}, {&other_bregma, 5.5, 1}, {&mirrored_bregma, 5.7, -1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const conus_frame *frame = cases[i].frame;
        for (int side = -1; side <= 1; side += 2) {
            conus_pose pose;
            const double at[3] = {cases[i].midline + 2.0 * side, 1, -2};
            double lateral = side * half;
            assert_ok(pose_along_tilts(&pose, at, 0, 0, frame));
            assert_axis(&pose, 0, 0, -1);
            assert_ok(pose_along_tilts(&pose, at, quarter, 0, frame));
            assert_axis(&pose, lateral, 0, -half);
            assert_ok(pose_along_tilts(&pose, at, -quarter, 0, frame));
            assert_axis(&pose, -lateral, 0, -half);
            assert_ok(pose_along_tilts(&pose, at, 0, quarter, frame));
            assert_axis(&pose, 0, half, -half);
            assert_ok(pose_along_tilts(&pose, at, quarter, quarter, frame));
            assert_axis(&pose, side * sqrt(1. / 3), sqrt(1. / 3), -sqrt(1. / 3));
            for (int a = 0; a < 3; a++) {
                assert_near(pose.world_from_device[12 + a], at[a], 0);
            }
            assert_int_equal(pose_is_mirrored(&pose), cases[i].right < 0);
        }
        conus_pose untouched = {{0}};
        const double middle[3] = {cases[i].midline, 1, -2};
        assert_fails(pose_along_tilts(&untouched, middle, 0.1, 0, frame), CONUS_ERROR_ARGUMENT);
        assert_ok(pose_along_tilts(&untouched, middle, 0, 0.1, frame));
    }
    conus_pose pose;
    const double at[3] = {1, 0, 0};
    assert_fails(pose_along_tilts(&pose, at, 2 * quarter, 0, &ras), CONUS_ERROR_ARGUMENT);
    assert_fails(pose_along_tilts(&pose, at, 0, NAN, &ras), CONUS_ERROR_ARGUMENT);
}

/* Eq. 24: phi = 0 has the top of the probe to the right of its tip, phi = 90 anterior of it. IBL's own example of a
 * probe in the left hemisphere, phi = 180 and theta = 15, comes in from the left and leads to the midline. */
static void phi_and_theta_lead_away_from_the_top(void **state)
{
    (void)state;
    const double degree = 0.017453292519943295;
    const conus_frame *const frames[] = {&ccf, &other_bregma, &mirrored_bregma};
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        const double right = frames[i] == &mirrored_bregma ? -1 : 1;
        const double at[3] = {3, -5, -1};
        conus_pose pose;
        assert_ok(pose_along_phi_theta(&pose, at, 0, 0, frames[i]));
        assert_axis(&pose, 0, 0, -1);
        assert_ok(pose_along_phi_theta(&pose, at, 180 * degree, 15 * degree, frames[i]));
        assert_axis(&pose, right * sin(15 * degree), 0, -cos(15 * degree));
        assert_ok(pose_along_phi_theta(&pose, at, 90 * degree, 30 * degree, frames[i]));
        assert_axis(&pose, 0, -0.5, -sqrt(0.75));
        assert_ok(pose_along_phi_theta(&pose, at, 60 * degree, 90 * degree, frames[i]));
        assert_axis(&pose, right * -0.5, -sqrt(0.75), 0);
        assert_fails(pose_along_phi_theta(&pose, at, NAN, 0, frames[i]), CONUS_ERROR_ARGUMENT);
    }
}

TEST_GROUP(pose_spaces)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ibl_picks_count_from_their_own_bregma), cmocka_unit_test(ibl_channels_say_where_bregma_lies),
        cmocka_unit_test(ibl_channels_begin_anywhere),           cmocka_unit_test(ibl_is_read_strictly),
        cmocka_unit_test(tilts_lead_lateral_and_anterior),       cmocka_unit_test(phi_and_theta_lead_away_from_the_top),
        cmocka_unit_test(tables_are_in_ccf_or_from_bregma),      cmocka_unit_test(a_row_of_another_space_is_refused),
        cmocka_unit_test(other_formats_are_not_in_ccf),          cmocka_unit_test(every_prefix_is_refused_or_shorter),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
