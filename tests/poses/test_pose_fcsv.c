/* SPDX-License-Identifier: BSD-3-Clause */
/* 3D Slicer's lists of fiducials. */
#include "conus/own.h"
#include "pose_checks.h"
#include "test.h"

/* LPS: x and y change their signs. A name may hold a comma between quotation marks. */
static void fiducials_are_points(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("fiducials.fcsv", NULL);
    assert_int_equal(conus_pose_list_count(list), 3);
    assert_true(pose_row_of(list, 0, "F-1")->is_point);
    assert_row_at(pose_row_of(list, 0, "F-1"), 1.5, 63, -49.75);
    assert_row_at(pose_row_of(list, 1, "tip, left"), 0, -20, 10);
    assert_row_at(pose_row_of(list, 2, "3"), -40, 7.25, -6);
    assert_int_equal(pose_row_of(list, 0, "F-1")->line, 4);
    assert_null(conus_pose_list_note(list, 0));
    conus_pose_list_destroy(list);
}

/* One point, (1, 2, 3) in RAS, as each version has it. */
static void fiducials_of_all_versions(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool lps; /* --space */
        const char *note;
    } cases[] = {
        {"# Fiducial List file /a.fcsv\n# version = 2\n# columns = label,x,y,z,sel,vis\nP,1,2,3,1,1\n", false, NULL},
        {"# Fiducial List file /a.fcsv\n# version = 2\nP,1,2,3,1,1\n", false, NULL},
        {"# name = L\n# columns = label,x,y,z,sel,vis\n\nP,1,2,3,1,1\n", false,
         "no line CoordinateSystem; taken as RAS"},
        {"# Fiducial List file\n# columns = label,x,y,z,sel,vis\nP,1,2,3\n", true, "the file says that"},
        {"# Markups fiducial file version = 4.6\n# CoordinateSystem = 0\nid,1,2,3,0,0,0,1,1,1,0,P,,\n", false, NULL},
        {"# Markups fiducial file version = 4.6\n# CoordinateSystem = 0\nid,1,2,3,0,0,0,1,1,1,0,P,,\n", true,
         "the file says that its positions are RAS"},
        {"# Markups fiducial file version = 4.8\n# CoordinateSystem = 1\nid,-1,-2,3,0,0,0,1,1,1,0,P\n", false, NULL},
        {"# Markups fiducial file version = 5.2\n# CoordinateSystem = RAS\n# columns = z,label,y,x\n3,P,2,1\n", false,
         NULL},
        {"# Markups fiducial file version = 5.2\r\nid,-1,-2,3,0,0,0,1,1,1,0,P,,\r\n", true, "taken as LPS"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_list *list = pose_text_parse(
            text_from(cases[i].text), &(conus_pose_options){.space = cases[i].lps ? CONUS_SPACE_LPS : CONUS_SPACE_RAS});
        assert_int_equal(conus_pose_list_count(list), 1);
        assert_row_at(pose_row_of(list, 0, "P"), 1, 2, 3);
        assert_true(cases[i].note ? pose_has_note(list, cases[i].note) : !conus_pose_list_note(list, 0));
        conus_pose_list_destroy(list);
    }
}

static void fiducials_are_read_strictly(void **state)
{
    (void)state;
    static const char head[] = "# Markups fiducial file version = 4.11\n# CoordinateSystem = RAS\n";
    pose_text_refuse(text_from("# Markups fiducial file version = 4.11\n# CoordinateSystem = 2\n"), NULL,
                     "CoordinateSystem \"2\": voxels, not mm: save it again in RAS or LPS");
    pose_text_refuse(text_from("# columns = id,x,y,z,z,label\n"), NULL, "a column z twice");
    pose_text_refuse(text_from("# Fiducial List file\n# columns = label,x,y\n"), NULL,
                     "columns: \"label,x,y\", x, y and z are needed");
    pose_text_refuse(text_from(head), &(conus_pose_options){.axis = CONUS_AXIS_PLUS_Z}, "no axis (+z)");
    conus_pose_list *list = pose_text_parse(text_from(head), NULL);
    assert_int_equal(conus_pose_list_count(list), 0);
    conus_pose_list_destroy(list);
    list = pose_text_parse(text_from("# Markups fiducial file version = 4.11\n# CoordinateSystem = RAS\n"
                                     "id,1,5,2,5,3,5,0,0,0,1,1,1,0,P,,\n" /* decimal commas */
                                     "id,1,2,3,0,0,0,1,1,1,0\n"
                                     "id,1,n/a,3,0,0,0,1,1,1,0,P,,\n"),
                           NULL);
    assert_row_fails(list, 0, "1", "17 fields, the header has 16");
    assert_row_fails(list, 1, "2", "11 fields, the header has 16");
    assert_row_fails(list, 2, "P", "y: \"n/a\" is not a finite number");
    conus_pose_list_destroy(list);
}

/* Points called left and right that lie on the other side, as far as the atlas is known to be long. */
static void sides_are_asked(void **state)
{
    (void)state;
    static const char text[] = "# Markups fiducial file version = 4.11\n# CoordinateSystem = RAS\n"
                               "1,42,-20,50,0,0,0,1,1,1,0,M1 left,,\n"
                               "2,-42,-20,50,0,0,0,1,1,1,0,M1 right,,\n";
    conus_pose_options options = {.longest = 200};
    pose_text_refuse(text_from(text), &options, "sides: 1 of 1 rows called left lie on the right, 1 of 1 called");
    options.columns = "sides=anyway";
    conus_pose_list *list = pose_text_parse(text_from(text), &options);
    assert_row_at(pose_row_of(list, 0, "M1 left"), 42, -20, 50);
    conus_pose_list_destroy(list);
    list = pose_text_parse(text_from(text), NULL);
    assert_int_equal(conus_pose_list_count(list), 2);
    conus_pose_list_destroy(list);
    options.columns = "unit=cm,sides=anyway";
    pose_text_refuse(text_from(text), &options, "is for tables, points and electrodes (BIDS), and not for markups");
    options.columns = NULL; /* LPS, as it should say; a third of a side may be wrong */
    list = pose_text_parse(text_from("# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
                                     "1,42,20,50,0,0,0,1,1,1,0,lh,,\n"
                                     "2,-42,20,50,0,0,0,1,1,1,0,rh,,\n"
                                     "3,-10,20,50,0,0,0,1,1,1,0,lh,,\n"
                                     "4,42,20,50,0,0,0,1,1,1,0,A1 left,,\n"),
                           &options);
    assert_int_equal(conus_pose_list_count(list), 4);
    conus_pose_list_destroy(list);
}

TEST_GROUP(pose_fcsv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fiducials_are_points),
        cmocka_unit_test(fiducials_of_all_versions),
        cmocka_unit_test(fiducials_are_read_strictly),
        cmocka_unit_test(sides_are_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
