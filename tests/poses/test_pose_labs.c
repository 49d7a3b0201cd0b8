/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses of InVesalius and NIBS-BIDS; for these, SimNIBS and Lead-DBS: formats and spaces, prefixes, allocations. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "poses/pose_stream.h"

#include "conus/own.h"
#include "pose_checks.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *format_of(const char *name)
{
    conus_pose_stream *stream = NULL;
    assert_ok(conus_pose_stream_open(&stream, pose_sample(name), NULL));
    const char *format = conus_pose_stream_facts(stream).format;
    conus_pose_stream_destroy(stream);
    return format;
}

static void formats_are_found(void **state)
{
    (void)state;
    assert_string_equal(format_of("simnibs.mat"), "simnibs");
    assert_string_equal(format_of("lead-dbs.mat"), "lead-dbs");
    assert_string_equal(format_of("invesalius.mkss"), "invesalius");
    assert_string_equal(format_of("markers.tsv"), "nibs");
    assert_string_equal(format_of("electrodes.tsv"), "electrodes");
    assert_string_equal(conus_pose_format_name(0), "auto");
    assert_null(conus_pose_format_name(16)); /* of 16 */
}

static void invesalius_markers(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("invesalius.mkss", NULL);
    assert_int_equal(conus_pose_list_count(list), 4);
    assert_true(pose_has_note(list, "2 fiducials were passed over"));
    assert_row_at_target(pose_row_of(list, 0, "hot spot"), 1e-6);
    assert_int_equal(pose_row_of(list, 0, "hot spot")->line, 5);
    assert_true(pose_row_of(list, 1, "C4")->is_point);
    assert_row_at(pose_row_of(list, 1, "C4"), 61, -19.5, 3);
    assert_row_at_target(pose_row_of(list, 2, "pulse 1"), 1e-6);
    assert_row_fails(list, 3, "lost", "x_world: not known");
    conus_pose_list_destroy(list);
}

#define MKSS "##INVESALIUS3_MARKER_FILE_4\n"
#define WORLD "x_world\ty_world\tz_world\talpha_world\tbeta_world\tgamma_world"

/* Turns about the fixed axes x, y, z, in this order; the coil's z points out of the head, so it looks along -z. A
 * quarter turn about x takes z to -y, one about y takes z to x, one about z takes -y to x. */
static void invesalius_angles(void **state)
{
    (void)state;
    conus_pose_list *list = pose_text_parse(text_from(MKSS "label\t" WORLD "\n"
                                                           "none\t1\t2\t3\t0\t0\t0\n"
                                                           "x\t1\t2\t3\t90\t0\t0\n"
                                                           "y\t1\t2\t3\t0\t90\t0\n"
                                                           "x z\t1\t2\t3\t90\t0\t90\n"
                                                           "y z\t1\t2\t3\t0\t90\t90\n"
                                                           "x y\t1\t2\t3\t90\t90\t0\n"),
                                            NULL);
    assert_row_along(pose_row_of(list, 0, "none"), 0, 0, -1);
    assert_row_along(pose_row_of(list, 1, "x"), 0, 1, 0);
    assert_row_along(pose_row_of(list, 2, "y"), -1, 0, 0);
    assert_row_along(pose_row_of(list, 3, "x z"), -1, 0, 0);
    assert_row_along(pose_row_of(list, 4, "y z"), 0, -1, 0);
    assert_row_along(pose_row_of(list, 5, "x y"), 0, 1, 0);
    assert_row_at(pose_row_of(list, 5, "x y"), 1, 2, 3);
    conus_pose_list_destroy(list);
}

/* Old files have no marker_type: the labels of the two ears and of the nasion mark fiducials. With the column, type 0
 * does. */
static void invesalius_fiducials_are_passed_over(void **state)
{
    (void)state;
    static const char *const labels[] = {"LEI", "REI", "NAI"};
    for (size_t i = 0; i < 3; i++) {
        char text[400];
        snprintf(text, sizeof text, MKSS "label\t" WORLD "\n%s\t1\t2\t3\t0\t0\t0\nNAS\t1\t2\t3\t0\t0\t0\n", labels[i]);
        conus_pose_list *list = pose_text_parse(text_from(text), NULL);
        assert_int_equal(conus_pose_list_count(list), 1);
        assert_row_at(pose_row_of(list, 0, "NAS"), 1, 2, 3);
        assert_true(pose_has_note(list, "1 fiducials were passed over"));
        conus_pose_list_destroy(list);
        snprintf(text, sizeof text, MKSS "label\tmarker_type\t" WORLD "\n%s\t1\t1\t2\t3\t0\t0\t0\n", labels[i]);
        list = pose_text_parse(text_from(text), NULL);
        assert_int_equal(conus_pose_list_count(list), 1);
        conus_pose_list_destroy(list);
    }
}

static void invesalius_is_read_strictly(void **state)
{
    (void)state;
    pose_text_refuse(text_from(MKSS), NULL, "without a header");
    pose_text_refuse(text_from("##INVESALIUS3_MARKER_FILE_x\n"), NULL, "\"x\" is no version");
    pose_text_refuse(text_from(MKSS "label\tx\ty\tz\talpha\tbeta\tgamma\n"), NULL, "without the column x_world");
    pose_text_refuse(text_from(MKSS WORLD "\tx_world\n"), NULL, "a column x_world twice");
    pose_text_refuse(text_from("label\n"), &(conus_pose_options){.format = "invesalius"}, "the first line is not");
    conus_pose_list *list = pose_text_parse(text_from("##INVESALIUS3_MARKER_FILE_9\n"
                                                      "\"label\"\t\"alpha\"\t" WORLD "\n"
                                                      "\"LEI\"\tNone\t1\t2\t3\t0\t0\t0\n"
                                                      "\"a\"\t0\t1\tx\t3\t0\t0\t0\n"
                                                      "\"b\"\t0\t1\t2\t3\t0\tNone\t0\n"
                                                      "\"c\"\t0\t1\t2\n"
                                                      "\"d\t0\t1\t2\t3\t0\t0\t0\n"
                                                      "\"LEI\"\tNone\t1\t2\n"),
                                            NULL);
    assert_int_equal(conus_pose_list_count(list), 5);
    assert_true(pose_has_note(list, "version 9; 0 to 4 are known"));
    assert_true(pose_has_note(list, "1 fiducials"));
    assert_row_fails(list, 0, "a", "y_world: \"x\"");
    assert_row_fails(list, 1, "b", "beta_world: \"None\"");
    assert_row_fails(list, 2, "c", "4 fields, the header has 8");
    assert_non_null(conus_pose_list_row(list, 3)->error);
    assert_row_fails(list, 4, "LEI", "4 fields");
    conus_pose_list_destroy(list);
}

static void nibs_markers(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("markers.tsv", NULL);
    assert_int_equal(conus_pose_list_count(list), 9);
    assert_true(pose_has_note(list, "no *_coordsystem.json"));
    static const char *const ids[] = {"coil", "out", "beam", "entry"};
    for (size_t i = 0; i < 4; i++) {
        assert_row_at_target(pose_row_of(list, i, ids[i]), 1e-6);
    }
    assert_true(pose_row_of(list, 4, "point")->is_point);
    assert_row_at(pose_row_of(list, 4, "point"), 0, -20, 10);
    assert_row_fails(list, 5, "matrix", "--axis says so");
    assert_row_fails(list, 6, "normal", "--axis +z points along it");
    assert_row_fails(list, 7, "aside", "90 degrees off the target");
    assert_row_fails(list, 8, "label", "no coordinates");
    conus_pose_list_destroy(list);
    list = pose_sample_load("markers.tsv", &(conus_pose_options){.axis = CONUS_AXIS_PLUS_Z});
    assert_row_at_target(pose_row_of(list, 5, "matrix"), 1e-6);
    assert_row_at_target(pose_row_of(list, 6, "normal"), 1e-6);
    conus_pose_list_destroy(list);
    list = pose_sample_load("markers.tsv", &(conus_pose_options){.axis = CONUS_AXIS_MINUS_Z});
    assert_row_at_target(pose_row_of(list, 1, "out"), 1e-6); /* its normal points out of the head */
    const double *m = pose_row_of(list, 5, "matrix")->pose.world_from_device;
    double beam[3];
    vec3_sub(beam, m + 12, pose_target);
    assert_near(vec3_dot(beam, m + 8), -80, 1e-6); /* it looks away */
    conus_pose_list_destroy(list);
    list = pose_sample_load("markers.tsv", &(conus_pose_options){.axis = CONUS_AXIS_PLUS_X});
    assert_row_fails(list, 6, "normal", "--axis +z points along it");
    conus_pose_list_destroy(list);
}

static void nibs_is_read_strictly(void **state)
{
    (void)state;
    const conus_pose_options nibs = {.format = "nibs"};
    pose_text_refuse(text_from("x\ttarget_id\n"), &nibs, "the first column is none of");
    pose_text_refuse(text_from(" \n"), &nibs, "no header");
    pose_text_refuse(text_from("nibs_event_id\tnibs_type\nA\tTMS\n"), NULL, "only *_markers.tsv has positions");
    pose_text_refuse(text_from("target_id\ttarget_x\tposition_x\n"), NULL, "a column position_x twice");
    pose_text_refuse(text_from("target_id\ttarget_x\ttarget_y\ttarget_z\n"),
                     &(conus_pose_options){.axis = CONUS_AXIS_PLUS_Z}, "neither a matrix nor a normal");
    static const char table[] = "nibs_position_id\tposition_x\tposition_y\tposition_z\tposition_coil_x\tposition_coil_y"
                                "\tposition_coil_z\tposition_coil_transform\n"
                                "half\t1\tn/a\t3\tn/a\tn/a\tn/a\tn/a\n"
                                "same\t1\t2\t3\t1\t2\t3\tn/a\n"
                                "short\t1\n"
                                "flat\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\t[1, 0, 0]\n"
                                "text\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\t[[1,\n"
                                "five\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\t[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1],[0]]\n"
                                "good\t1\t2\t3\t1\t2\t9\tn/a\n";
    conus_pose_list *list = pose_text_parse(text_from(table), &(conus_pose_options){.axis = CONUS_AXIS_PLUS_Z});
    assert_row_fails(list, 0, "half", "\"n/a\" is not a finite number");
    assert_row_fails(list, 1, "same", "is the origin itself");
    assert_row_fails(list, 2, "short", "2 fields, the header has 8");
    assert_row_fails(list, 3, "flat", "the coil's matrix: four lists of four numbers");
    assert_row_fails(list, 4, "text", "the coil's matrix");
    assert_row_fails(list, 5, "five", "four lists of four numbers");
    assert_row_along(pose_row_of(list, 6, "good"), 0, 0, -1);
    conus_pose_list_destroy(list);
}

/* Without a named space --space counts: for points, directions and matrices. */
static void nibs_in_lps(void **state)
{
    (void)state;
    static const char table[] =
        "target_id\ttarget_x\ttarget_y\ttarget_z\tentry_x\tentry_y\tentry_z\tbeam_x\tbeam_y\tbeam_z"
        "\tcoil_transform\n"
        "toward\t1\t2\t3\t5\t2\t3\tn/a\tn/a\tn/a\tn/a\n"
        "beam\tn/a\tn/a\tn/a\t5\t2\t3\t0\t7\t0\tn/a\n"
        "none\tn/a\tn/a\tn/a\t5\t2\t3\t0\t0\t0\tn/a\n"
        "matrix\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\t"
        "[[0,0,1,4],[1,0,0,5],[0,1,0,6],[0,0,0,1]]\n";
    conus_pose_list *list =
        pose_text_parse(text_from(table), &(conus_pose_options){.space = CONUS_SPACE_LPS, .axis = CONUS_AXIS_PLUS_Z});
    assert_row_at(pose_row_of(list, 0, "toward"), -5, -2, 3);
    assert_row_along(pose_row_of(list, 0, "toward"), 1, 0, 0);
    assert_row_along(pose_row_of(list, 1, "beam"), 0, -1, 0);
    assert_row_fails(list, 2, "none", "direction: ");
    assert_row_at(pose_row_of(list, 3, "matrix"), -4, -5, 6);
    assert_row_along(pose_row_of(list, 3, "matrix"), -1, 0, 0);
    conus_pose_list_destroy(list);
    list = pose_text_parse(text_from("target_id\tcoil_x\tcoil_y\tcoil_z\tnormal_x\tnormal_y\tnormal_z\n"
                                     "a\t1\t2\t3\t0\t0\t0\nb\t1\t2\t3\tn/a\tn/a\tn/a\n"),
                           NULL);
    assert_row_fails(list, 0, "a", "a normal of length 0");
    assert_row_fails(list, 1, "b", "no coordinates of a target, nor of a coil or entry with a direction");
    conus_pose_list_destroy(list);
}

static void write_text(const char *path, const char *text)
{
    assert_ok(file_write(path, text, strlen(text)));
}

/* Units and space are beside the table; a named space is RAS. */
static void nibs_coordinate_systems(void **state)
{
    (void)state;
    char table[4096];
    snprintf(table, sizeof table, "%s", test_scratch("sub-1_task-rest_acq-a_run-1_markers.tsv"));
    write_text(table, "target_id\ttarget_x\ttarget_y\ttarget_z\tcoil_transform\n"
                      "spot\t-2\t3\t4\tn/a\n"
                      "coil\t-2\t3\t4\t[[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]\n");
    write_text(test_scratch("sub-1_task-rest_coordsystem.json"),
               "{\"NIBSCoordinateSystem\":\"IndividualMRI\",\"NIBSCoordinateUnits\":\"cm\"}");
    conus_pose_stream *stream = NULL;
    conus_pose_row rows[2];
    size_t count = 0;
    assert_ok(conus_pose_stream_open(&stream, table, &(conus_pose_options){.space = CONUS_SPACE_LPS}));
    assert_string_equal(conus_pose_stream_facts(stream).space, "IndividualMRI");
    assert_string_equal(conus_pose_stream_facts(stream).coordsystem, test_scratch("sub-1_task-rest_coordsystem.json"));
    assert_ok(conus_pose_stream_read(rows, &count, stream, 2));
    assert_row_at(&rows[0], -20, 30, 40);
    assert_non_null(strstr(rows[1].error, "--axis says so")); /* and no point at the target */
    conus_pose_stream_destroy(stream);
    assert_ok(conus_pose_stream_open(&stream, table, &(conus_pose_options){.axis = CONUS_AXIS_MINUS_Z}));
    assert_ok(conus_pose_stream_read(rows, &count, stream, 2));
    assert_row_at(&rows[1], 10, 20, 30);
    conus_pose_stream_destroy(stream);
    write_text(test_scratch("sub-1_task-rest_coordsystem.json"),
               "{\"NIBSCoordinateSystem\":\"CapTrak\",\"NIBSCoordinateUnits\":\"mm\"}");
    assert_fails(conus_pose_stream_open(&stream, table, NULL), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "\"CapTrak\" is not the world of an image"));
}

/* A subject's own head is no template; a reconstruction in MNI space is in one. */
static void spaces_must_fit(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        const char *format;
        bool fits;
    } cases[] = {{"simnibs.mat", "auto", false},
                 {"invesalius.mkss", "auto", false},
                 {"lead-dbs.mat", "auto", true},
                 {"lead-dbs.mat", "lead-dbs-native", false}};
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    bool is_template = strstr(conus_atlas_volume(atlas, 0)->transform, "MNI 152");
    for (size_t i = 0; is_template && i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_list *list = pose_sample_load(cases[i].name, &(conus_pose_options){.format = cases[i].format});
        assert_int_equal(conus_pose_list_match(list, atlas), cases[i].fits ? CONUS_OK : CONUS_ERROR_DATA);
        conus_pose_list_destroy(list);
    }
    conus_atlas_destroy(atlas);
}

/* An atlas that was moved to the patient fits the patient's coils, but no longer contacts in MNI space. */
static void a_moved_atlas_is_the_patients(void **state)
{
    (void)state;
    static const double right[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 0, 0, 1};
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    assert_ok(conus_atlas_move(atlas, right));
    conus_pose_list *coils = pose_sample_load("simnibs.mat", NULL);
    assert_ok(conus_pose_list_match(coils, atlas));
    assert_null(conus_pose_list_note(coils, 0));
    conus_pose_list_destroy(coils);
    conus_pose_list *contacts = pose_sample_load("lead-dbs.mat", NULL);
    assert_ok(conus_pose_list_match(contacts, atlas));
    assert_true(pose_has_note(contacts, "they must be where the atlas was moved to"));
    conus_pose_list_destroy(contacts);
    conus_atlas_destroy(atlas);
}

/* Contacts in metres, 0.05 to 0.1 from the origin; and the same where the scanner's origin is 1.2 m away. In every
 * format three such positions give a note. Two positions, as of a microelectrode, give one only near the origin; equal
 * positions and rows with an error never do. Cones of a pose table are left to conus_pose_check_found(). */
static void positions_in_metres_are_noted(void **state)
{
    (void)state;
    static const char near_origin[] = "all positions lie within 1 mm of the origin, as if they were in metres";
    static const char near_each_other[] = "all positions lie within 0.2 mm of each other, as if they were in metres";
    static const struct {
        const char *text, *note;
        conus_space space;
    } cases[] = {
        {"name\tx\ty\tz\nA\t0.05\t0.01\t0.09\nB\t-0.05\t0.01\t0.09\nC\tn/a\tn/a\tn/a\n", near_origin, 0},
        {"name\tx\ty\tz\nA\t.05\t.01\t1.2\nB\t-.05\t.01\t1.2\nC\t0\t.1\t1.1\n", near_each_other, 0},
        {"name\tx\ty\tz\nA\t.05\t.01\t1.2\nB\t-.05\t.01\t1.2\n", NULL, 0},
        {"name\tx\ty\tz\nA\t9\t9\t9\nB\t9\t9\t9\nC\t9\t9\t9\n", NULL, 0},
        {"name\tx\ty\tz\nA\t0\t0\t0\n", NULL, 0},
        {"name\tx\ty\tz\nA\t.05\t.01\t1.2\nB\t-.05\t.01\t1.2\nC\t0\t.1\t1.41\n", NULL, 0},
        {".05 .01 .09 A\n-.05 .01 .09 B\n", near_origin, 0},
        {".05 .01 .09 A\n-.05 .01 .09 B\n", near_origin, CONUS_SPACE_LPS},
        {".05 .01 .09 A\n-.05 .01 x B\n", near_origin, 0},
        {"9 9 9 A\n9 9 9.01 B\n9 9 9.02 C\n", near_each_other, 0},
        {"9 9 -9 A\n9 9 -9.01 B\n9 9 -9.02 C\n", NULL, CONUS_SPACE_BREGMA},
        {"x,y,z,dx,dy,dz\n.1,.1,.1,0,0,1\n.1,.1,.2,0,0,1\n.1,.1,.15,0,0,1\n", NULL, 0},
        {"# Fiducial List file\n# columns = label,x,y,z,sel,vis\nA,.1,0,0,1,1\n", near_origin, 0},
    };
    const conus_frame bregma = {.space = CONUS_SPACE_BREGMA, .world_from_space = {1, [5] = 1, [10] = 1, [15] = 1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const conus_pose_options options = {.space = cases[i].space,
                                            .frame = cases[i].space == CONUS_SPACE_BREGMA ? &bregma : NULL};
        conus_pose_list *list = pose_text_parse(text_from(cases[i].text), &options);
        if (cases[i].note ? !pose_has_note(list, cases[i].note) : pose_has_note(list, "in metres")) {
            fail_msg("case %zu", i);
        }
        conus_pose_list_destroy(list);
    }
}

static const struct {
    const char *name;
    const char *format;
} samples[] = {{"simnibs.mat", "auto"},     {"simnibs.txt", "simnibs"},
               {"lead-dbs.mat", "auto"},    {"lead-dbs.mat", "lead-dbs-native"},
               {"invesalius.mkss", "auto"}, {"markers.tsv", "auto"}};

enum { SAMPLES = sizeof samples / sizeof samples[0] };

/* A file that is cut off is refused or gives the first of its rows, the last of them perhaps with an error. */
static void every_prefix_is_refused_or_shorter(void **state)
{
    (void)state;
    for (size_t k = 0; k < SAMPLES; k++) {
        const conus_pose_options options = {.format = samples[k].format};
        struct bytes bytes = {0};
        conus_pose_list *whole = pose_sample_load(samples[k].name, &options);
        assert_ok(file_read(&bytes, pose_sample(samples[k].name), 1 << 20));
        for (size_t size = 0; size < bytes.size; size++) {
            conus_pose_list *list = NULL;
            char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
            memcpy(exact, bytes.data, size);
            (void)!pose_list_parse(&list, (struct text){exact, size}, &options);
            size_t count = conus_pose_list_count(list);
            assert_true(count <= conus_pose_list_count(whole));
            for (size_t i = 0; i + 1 < count; i++) {
                bool same = !conus_pose_list_row(list, i)->error == !conus_pose_list_row(whole, i)->error;
                assert_true(same);
            }
            conus_pose_list_destroy(list);
            free(exact);
        }
        conus_pose_list_destroy(whole);
        bytes_finish(&bytes);
    }
}

static conus_status load_sample(void *index)
{
    conus_pose_list *list = NULL;
    const size_t *k = index;
    conus_status status =
        conus_pose_list_load(&list, pose_sample(samples[*k].name), &(conus_pose_options){.format = samples[*k].format});
    conus_pose_list_destroy(list);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    for (size_t k = 0; k < SAMPLES; k++) {
        test_every_allocation(load_sample, &k);
    }
}

TEST_GROUP(pose_labs)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formats_are_found),
        cmocka_unit_test(invesalius_markers),
        cmocka_unit_test(invesalius_angles),
        cmocka_unit_test(invesalius_fiducials_are_passed_over),
        cmocka_unit_test(invesalius_is_read_strictly),
        cmocka_unit_test(nibs_markers),
        cmocka_unit_test(nibs_is_read_strictly),
        cmocka_unit_test(nibs_in_lps),
        cmocka_unit_test(nibs_coordinate_systems),
        cmocka_unit_test(spaces_must_fit),
        cmocka_unit_test(a_moved_atlas_is_the_patients),
        cmocka_unit_test(positions_in_metres_are_noted),
        cmocka_unit_test(every_prefix_is_refused_or_shorter),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
