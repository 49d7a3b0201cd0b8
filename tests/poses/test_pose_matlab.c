/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses in MATLAB's files: of SimNIBS, also as text, and of Lead-DBS. scipy wrote the samples. */
#include "base/geometry/math3.h"
#include "poses/pose_stream.h"

#include "builders/matlab_builder.h"
#include "pose_checks.h"
#include "test.h"

#include <string.h>

/* A TMSLIST in a SESSION; a position that SimNIBS has not placed is an error of its row. */
static void simnibs_sessions(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("simnibs.mat", NULL);
    assert_int_equal(conus_pose_list_count(list), 3);
    assert_row_at_target(pose_row_of(list, 0, "M1 left"), 1e-6);
    assert_row_at_target(pose_row_of(list, 1, "2"), 1e-6);
    assert_row_fails(list, 2, "planned", "matsimnibs is empty");
    conus_pose_list_destroy(list);
    list = pose_sample_load("simnibs.mat", &(conus_pose_options){.axis = CONUS_AXIS_MINUS_Z});
    double beam[3];
    const double *m = pose_row_of(list, 0, "M1 left")->pose.world_from_device;
    vec3_sub(beam, m + 12, pose_target);
    assert_near(vec3_dot(beam, m + 8), -80, 1e-9); /* it looks away */
    conus_pose_list_destroy(list);
}

static const conus_pose_options simnibs = {.format = "simnibs"};

/* SimNIBS's manual has a coil above the vertex that faces downwards, with its y forward: [-1 0 0 -1.2; 0 1 0 -15.8; 0 0
 * -1 120; 0 0 0 1]. */
static void simnibs_texts(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("simnibs.txt", &simnibs);
    assert_int_equal(conus_pose_list_count(list), 2);
    assert_row_at_target(pose_row_of(list, 0, "1"), 1e-6);
    assert_row_at_target(pose_row_of(list, 1, "2"), 1e-6);
    assert_int_equal(pose_row_of(list, 0, "1")->line, 2);
    assert_int_equal(pose_row_of(list, 1, "2")->line, 7);
    conus_pose_list_destroy(list);
    static const char *const manual[] = {/* as Python and as MATLAB write it */
                                         "[-1, 0, 0, -1.2],\n[0, 1, 0, -15.8],\n[0, 0, -1, 120.0],\n[0, 0, 0, 1]]",
                                         "[-1 0 0 -1.2; 0 1 0 -15.8; 0 0 -1 120; 0 0 0 1];"};
    for (int i = 0; i < 2; i++) {
        list = pose_text_parse(text_from(manual[i]), &simnibs);
        assert_row_along(pose_row_of(list, 0, "1"), 0, 0, -1);
        assert_row_at(pose_row_of(list, 0, "1"), -1.2, -15.8, 120);
        assert_near(pose_row_of(list, 0, "1")->pose.world_from_device[5], 1, 1e-12); /* +y stays up */
        conus_pose_list_destroy(list);
    }
    list = pose_text_parse(text_from("1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1\n1 0 0 0 0 1 0.1 0 0 0 1 0 0 0 0 1\n"
                                     "nan 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1\n"
                                     "1 0 0 .1 0 1 0 0 0 0 1 .09 0 0 0 1"),
                           &simnibs);
    assert_row_fails(list, 0, "1", "left-handed");
    assert_row_fails(list, 1, "2", "columns 2 and 3 are not at a right angle");
    assert_row_fails(list, 2, "3", "nan in row 1");
    assert_row_fails(list, 3, "4", "last row 5 6 7 1");
    assert_null(pose_row_of(list, 4, "5")->error);
    assert_true(pose_has_note(list, "as if they were in metres"));
    conus_pose_list_destroy(list);
    pose_text_refuse(text_from(""), &simnibs, "0 numbers, a matsimnibs is 16");
    pose_text_refuse(text_from("1 2 3"), &simnibs, "3 numbers, a matsimnibs is 16");
    pose_text_refuse(text_from("1 2\n3 x"), &simnibs, "line 2: \"x\" is no number");
}

/* Positions in variables of MATLAB, without a SESSION. */
static void simnibs_variables(void **state)
{
    (void)state;
    static const double down[32] = {
        -1, 0, 0,  0, 0, 1, 0, 0, 0, 0, -1, 0, 1,   2, 90, 1, /* and once more to the left */
        0,  0, -1, 0, 0, 1, 0, 0, 1, 0, 0,  0, -90, 2, 3,  1};
    static const uint16_t name[] = {'M', '1'};
    enum { DIMENSIONS = 128 + 8 + 16 }; /* behind the header, the array's tag and its flags */
    for (int big = 0; big < 2; big++) {
        struct matlab_builder builder;
        matlab_begin(&builder, big);
        matlab_chars(&builder, "name", name, 2);
        matlab_open(&builder, MX_DOUBLE, 4, 8, "other");
        matlab_values(&builder, MI_DOUBLE, down, 32);
        matlab_close(&builder);
        pose_text_refuse(matlab_built(&builder), NULL, "without matsimnibs (SimNIBS) and reco (Lead-DBS)");
        matlab_doubles(&builder, "matsimnibs", 4, 4, down);
        conus_pose_list *list = pose_text_parse(matlab_built(&builder), NULL);
        assert_int_equal(conus_pose_list_count(list), 1);
        assert_row_along(pose_row_of(list, 0, "M1"), 0, 0, -1);
        assert_row_at(pose_row_of(list, 0, "M1"), 1, 2, 90);
        conus_pose_list_destroy(list);
        buffer_finish(&builder.bytes);

        matlab_begin(&builder, big);
        matlab_open(&builder, MX_DOUBLE, 4, 4, "");
        builder.bytes.size = DIMENSIONS; /* it has three dimensions */
        matlab_values(&builder, MI_INT32, (const double[]){4, 4, 2}, 3);
        matlab_element(&builder, MI_INT8, "matsimnibs", 10);
        matlab_values(&builder, MI_DOUBLE, down, 32);
        matlab_close(&builder);
        list = pose_text_parse(matlab_built(&builder), NULL);
        assert_int_equal(conus_pose_list_count(list), 2);
        assert_row_along(pose_row_of(list, 1, "2"), 1, 0, 0);
        assert_row_at(pose_row_of(list, 1, "2"), -90, 2, 3);
        conus_pose_list_destroy(list);
        buffer_finish(&builder.bytes);
    }
}

static void simnibs_is_read_strictly(void **state)
{
    (void)state;
    static const double numbers[16] = {0};
    struct matlab_builder builder;
    matlab_begin(&builder, false);
    matlab_open(&builder, MX_STRUCT, 1, 3, "pos");
    matlab_field_names(&builder, "matsimnibs");
    matlab_doubles(&builder, "", 4, 3, numbers);
    matlab_open(&builder, MX_CELL, 1, 0, "");
    matlab_close(&builder);
    matlab_open(&builder, MX_CELL, 1, 1, "");
    matlab_doubles(&builder, "", 4, 4, numbers);
    matlab_close(&builder);
    matlab_close(&builder);
    conus_pose_list *list = pose_text_parse(matlab_built(&builder), NULL);
    assert_int_equal(conus_pose_list_count(list), 3);
    assert_row_fails(list, 0, "1", "an array of numbers with 4 x 3, 4 x 4 numbers are needed");
    assert_row_fails(list, 1, "2", "matsimnibs is empty");
    assert_row_fails(list, 2, "3", "a cell array with 1 x 1");
    conus_pose_list_destroy(list);
    assert_fails(pose_list_parse(&list, matlab_built(&builder), &(conus_pose_options){.max_memory = 500}),
                 CONUS_ERROR_MEMORY);
    buffer_finish(&builder.bytes);

    matlab_begin(&builder, false);
    matlab_open(&builder, MX_STRUCT, 1, 0, "pos"); /* a list without positions */
    matlab_field_names(&builder, "name matsimnibs");
    matlab_close(&builder);
    list = pose_text_parse(matlab_built(&builder), NULL);
    assert_int_equal(conus_pose_list_count(list), 0);
    conus_pose_list_destroy(list);
    buffer_finish(&builder.bytes);
    pose_text_refuse(text_from("MATLAB 7.3 MAT-file, Platform: GLNXA64\n"), NULL, "39 bytes, 128 are needed");
}

/* Contacts are points: those of lead 1, on the right, and of lead 2, on the left, each from the lowest up. */
static void lead_dbs_contacts(void **state)
{
    (void)state;
    static const struct {
        const char *format;
        double shift;
        const char *note;
    } cases[] = {{"auto", 0, "in MNI space, reco.mni"},
                 {"lead-dbs", 0, "in MNI space, reco.mni"},
                 {"lead-dbs-native", 50, "in the patient's own space, reco.scrf"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_list *list = pose_sample_load("lead-dbs.mat", &(conus_pose_options){.format = cases[i].format});
        double shift = cases[i].shift;
        assert_int_equal(conus_pose_list_count(list), 6);
        assert_true(pose_has_note(list, cases[i].note));
        assert_row_at(pose_row_of(list, 0, "R1"), 11.5 + shift, -14 + shift, -8 + shift);
        assert_row_at(pose_row_of(list, 3, "R4"), 13 + shift, -11 + shift, -2.75 + shift);
        assert_row_at(pose_row_of(list, 5, "L2"), -12 + shift, -13 + shift, -6.25 + shift);
        assert_true(pose_row_of(list, 4, "L1")->is_point);
        conus_pose_list_destroy(list);
    }
    conus_pose_list *list = NULL;
    assert_fails(
        conus_pose_list_load(&list, pose_sample("lead-dbs.mat"), &(conus_pose_options){.axis = CONUS_AXIS_PLUS_Z}),
        CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "no axis (+z)"));
    assert_fails(conus_pose_list_load(&list, pose_sample("lead-dbs.mat"), &(conus_pose_options){.along_shafts = true}),
                 CONUS_ERROR_DATA);
    assert_non_null(
        strstr(conus_message(),
               "shafts are for electrodes (BIDS: name, x, y, z, size, with tabs, in *_electrodes.tsv), not for"));
}

/* reco.native.coords_mm = {[], contacts, contacts}, without any other space. */
static void build_native(struct matlab_builder *builder, int rows, int columns, uint32_t kind)
{
    static const double contacts[6] = {1, 2, 3, 40, 5, 6};
    matlab_begin(builder, false);
    matlab_open(builder, MX_STRUCT, 1, 1, "reco");
    matlab_field_names(builder, "native");
    matlab_open(builder, MX_STRUCT, 1, 1, "");
    matlab_field_names(builder, "coords_mm");
    matlab_open(builder, kind, 1, kind == MX_CELL ? 3 : 6, "");
    if (kind == MX_CELL) {
        matlab_element(builder, MI_MATRIX, "", 0);
        matlab_doubles(builder, "", rows, columns, contacts);
        matlab_doubles(builder, "", rows, columns, contacts);
    } else {
        matlab_values(builder, MI_DOUBLE, contacts, 6);
    }
    matlab_close(builder);
    matlab_close(builder);
    matlab_close(builder);
}

static void lead_dbs_is_read_strictly(void **state)
{
    (void)state;
    struct matlab_builder builder;
    build_native(&builder, 2, 3, MX_CELL);
    conus_pose_list *list = pose_text_parse(matlab_built(&builder), NULL);
    assert_int_equal(conus_pose_list_count(list), 4);
    assert_true(pose_has_note(list, "in the patient's own space, reco.native"));
    assert_row_at(pose_row_of(list, 0, "L1"), 1, 3, 5);
    assert_row_at(pose_row_of(list, 1, "L2"), 2, 40, 6);
    assert_row_at(pose_row_of(list, 2, "lead3-1"), 1, 3, 5);
    conus_pose_list_destroy(list);
    buffer_finish(&builder.bytes);
    build_native(&builder, 3, 2, MX_CELL);
    pose_text_refuse(matlab_built(&builder), NULL, "coords_mm{2}: an array of numbers with 3 x 2, contacts x 3");
    buffer_finish(&builder.bytes);
    build_native(&builder, 2, 3, MX_DOUBLE);
    pose_text_refuse(matlab_built(&builder), NULL, "coords_mm: an array of numbers, a cell array");
    pose_text_refuse(matlab_built(&builder), &simnibs, "without matsimnibs");
    buffer_finish(&builder.bytes);
    const conus_pose_options lead = {.format = "lead-dbs"};
    pose_text_refuse(text_from("1 2 3\n"), &lead, "not a file of MATLAB");
    static const double number = 1;
    matlab_begin(&builder, false);
    matlab_doubles(&builder, "reco", 1, 1, &number);
    pose_text_refuse(matlab_built(&builder), NULL, "reco: an array of numbers, a structure is needed");
    buffer_finish(&builder.bytes);
}

/* Older files have no reco, and are in MNI space. An unknown contact is an error of its row. */
static void lead_dbs_of_old(void **state)
{
    (void)state;
    const double contacts[6] = {1, NAN, 3, 40, 5, 6};
    struct matlab_builder builder;
    matlab_begin(&builder, true);
    matlab_open(&builder, MX_CELL, 1, 1, "coords_mm");
    matlab_doubles(&builder, "", 2, 3, contacts);
    matlab_close(&builder);
    conus_pose_list *list = pose_text_parse(matlab_built(&builder), NULL);
    assert_true(pose_has_note(list, "in MNI space"));
    assert_row_at(pose_row_of(list, 0, "R1"), 1, 3, 5);
    assert_row_fails(list, 1, "R2", "allowed are finite numbers");
    conus_pose_list_destroy(list);
    pose_text_refuse(matlab_built(&builder), &(conus_pose_options){.format = "lead-dbs-native"},
                     "no positions of contacts, reco.native.coords_mm");
    buffer_finish(&builder.bytes);
}

TEST_GROUP(pose_matlab)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(simnibs_sessions),  cmocka_unit_test(simnibs_texts),
        cmocka_unit_test(simnibs_variables), cmocka_unit_test(simnibs_is_read_strictly),
        cmocka_unit_test(lead_dbs_contacts), cmocka_unit_test(lead_dbs_is_read_strictly),
        cmocka_unit_test(lead_dbs_of_old),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
