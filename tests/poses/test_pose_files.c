/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses in files of other programs. The devices of the samples (tests/fuzz/corpus/poses) are 80 mm from (0, -20, 10)
 * and look at it. */
#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "pose_checks.h"
#include "poses/pose_stream.h"
#include "poses/programs/pose_programs.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static conus_pose_list *parse(const char *text, const conus_pose_options *options)
{
    return pose_text_parse(text_from(text), options);
}

static void refuse(const char *text, const conus_pose_options *options, const char *part)
{
    pose_text_refuse(text_from(text), options, part);
}

/* Parses a file of a known format without any pose. */
static void parse_none(const char *text)
{
    conus_pose_list *list = parse(text, NULL);
    assert_int_equal(conus_pose_list_count(list), 0);
    assert_null(conus_pose_list_row(list, 0));
    conus_pose_list_destroy(list);
}

static void brainsight_targets_samples_electrodes(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("brainsight.txt", NULL);
    assert_int_equal(conus_pose_list_count(list), 7);
    assert_row_at_target(pose_row_of(list, 0, "target/M1 left"), 0.1);
    assert_row_at_target(pose_row_of(list, 1, "target/vertex"), 0.1);
    const conus_pose_row *row = pose_row_of(list, 2, "sample/Sample 1");
    assert_row_at_target(row, 0.01);
    assert_int_equal(row->line, 11);
    /* Target Error, 1.348 mm, and Angular Error, 4.702 degrees, are the coil's distances from the planned target; they
     * are no errors of the measured position. */
    assert_true(isnan(row->error_mm) && isnan(row->error_deg));
    double first = row->time_s;
    assert_near(first, 1553263720.658, 1e-6); /* 2019-03-22 14:08:40.658 */
    assert_row_fails(list, 3, "sample/Sample 2", "Loc. X: \"(null)\"");
    row = pose_row_of(list, 4, "sample/Sample 3");
    assert_row_at_target(row, 0.01);
    assert_true(isnan(row->error_mm) && isnan(row->error_deg));
    assert_near(row->time_s - first, 9 * 3600 + 51 * 60 + 19.842, 1e-6); /* over midnight */
    assert_row_at_target(pose_row_of(list, 5, "electrode/C4"), 0.01);
    row = pose_row_of(list, 6, "electrode/Left Ear");
    assert_true(row->is_point);
    assert_near(row->pose.world_from_device[12], 75.4765, 1e-9);
    assert_true(pose_has_note(list, "2 rows of landmarks"));
    conus_pose_list_destroy(list);
}

/* World is DICOM's: x and y grow to the left and to the back. A file of one kind has plain names. */
static void brainsight_world_is_lps(void **state)
{
    (void)state;
    conus_pose_list *nifti = pose_sample_load("brainsight.txt", NULL);
    conus_pose_list *world = pose_sample_load("brainsight-world.txt", NULL);
    const conus_pose_row *row = pose_row_of(world, 0, "M1 left");
    assert_row_at_target(row, 0.1);
    for (int i = 0; i < 16; i++) {
        assert_near(row->pose.world_from_device[i], pose_row_of(nifti, 0, "target/M1 left")->pose.world_from_device[i],
                    1e-9);
    }
    conus_pose_list_destroy(nifti);
    conus_pose_list_destroy(world);
}

#define SPACE "# Coordinate system: NIfTI:Scanner\n"
#define COLUMNS "# Target Name\tLoc. X\tLoc. Y\tLoc. Z\tm0n0\tm0n1\tm0n2\tm1n0\tm1n1\tm1n2\tm2n0\tm2n1\tm2n2\n"

/* Each name of a coordinate system and of a unit that Brainsight writes, and the space that it means. */
static void brainsight_names_spaces_and_units(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum pose_brain brain;
    } spaces[] = {{"NIfTI:Scanner", POSE_BRAIN_SUBJECT},
                  {"NIfTI:S:Scanner", POSE_BRAIN_SUBJECT},
                  {"NIfTI:Q:Scanner", POSE_BRAIN_SUBJECT},
                  {"NIfTI:MNI-152", POSE_BRAIN_MNI152},
                  {"NIfTI:Q:MNI-152", POSE_BRAIN_MNI152},
                  {"NIfTI:Talairach", POSE_BRAIN_TALAIRACH},
                  {"NIfTI:S:Talairach", POSE_BRAIN_TALAIRACH},
                  {"NIfTI:Aligned", POSE_BRAIN_UNKNOWN},
                  {"World", POSE_BRAIN_SUBJECT}};
    static const char *const units[] = {"# Units: millimetres\n", "# Units: millimeters\n", "# Units: mm\n",
                                        "# units: mm\n"};
    for (size_t i = 0; i < sizeof spaces / sizeof spaces[0]; i++) {
        char text[512];
        snprintf(text, sizeof text, "# Coordinate system: %s\n%s" COLUMNS, spaces[i].name, units[i % 4]);
        conus_pose_list *list = parse(text, NULL);
        assert_int_equal(list->space.brain, spaces[i].brain);
        conus_pose_list_destroy(list);
    }
}

static void brainsight_is_read_strictly(void **state)
{
    (void)state;
    refuse("# Coordinate system: Brainsight\n" COLUMNS, NULL, "\"Brainsight\" is not the world of an image");
    refuse(COLUMNS "a\t0\t0\t0\t1\t0\t0\t0\t1\t0\t0\t0\t1\n", NULL, "no line \"# Coordinate system: ...\" above it");
    refuse(SPACE "# Units: inches\n" COLUMNS, NULL, "units \"inches\"");
    refuse(SPACE "# Target Name\tLoc. X\tLoc. Y\n", NULL, "no columns Loc. X, Loc. Y, Loc. Z");
    refuse(SPACE "# Target Name\tLoc. X\tLoc. Y\tLoc. Z\tm0n0\n", NULL, "only some of the columns");
    parse_none(SPACE COLUMNS);
    conus_pose_list *list =
        parse("# Coordinate system: NIfTI:S:MNI-152\n" COLUMNS "left\t0\t0\t0\t-1\t0\t0\t0\t1\t0\t0\t0\t1\n"
              "skewed\t0\t0\t0\t1\t0.1\t0\t0\t1\t0\t0\t0\t1\n"
              "rounded\t0\t0\t0\t1.0007\t0\t0\t0\t1\t0\t0\t0\t1\n"
              "short\t0\t0\t0\t1\t0\n"
              "holes\t0\t0\t0\t1\t(null)\t0\t0\t1\t0\t0\t0\t1\n"
              "nan\tnan\t0\t0\t1\t0\t0\t0\t1\t0\t0\t0\t1\n",
              NULL);
    assert_row_fails(list, 0, "left", "left-handed");
    assert_row_fails(list, 1, "skewed", "column 1 is 1.00499 long, not 1 within 0.001");
    assert_null(pose_row_of(list, 2, "rounded")->error);
    assert_row_fails(list, 3, "short", "6 fields, the header has 13");
    assert_row_fails(list, 4, "holes", "m0n1: \"(null)\"");
    assert_row_fails(list, 5, "nan", "Loc. X: \"nan\"");
    conus_pose_list_destroy(list);
}

static void names_are_whole_or_refused(void **state)
{
    (void)state;
    static const char text[] = SPACE COLUMNS "a\0b\t0\t0\t0\t1\t0\t0\t0\t1\t0\t0\t0\t1\n"
                                             "\xff\t0\t0\t0\t1\t0\t0\t0\t1\t0\t0\t0\t1\n";
    conus_pose_list *list = NULL;
    assert_ok(pose_list_parse(&list, (struct text){text, sizeof text - 1}, NULL));
    assert_row_fails(list, 0, "1", "the name has a zero byte");
    assert_row_fails(list, 1, "2", "the name is not UTF-8 text");
    conus_pose_list_destroy(list);
    char line[1024];
    char name[300];
    memset(name, 'n', sizeof name);
    for (int size = 255; size <= 256; size++) {
        snprintf(line, sizeof line, "1 2 3 %.*s\n", size, name);
        list = parse(line, NULL);
        const conus_pose_row *row = conus_pose_list_row(list, 0);
        assert_int_equal(strlen(row->id), size == 255 ? 255 : 1);
        assert_true((row->error != NULL) == (size == 256));
        conus_pose_list_destroy(list);
    }
}

static void localite_markers_look_along_x(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("localite-instrument.xml", NULL);
    assert_int_equal(conus_pose_list_count(list), 4);
    assert_row_at_target(pose_row_of(list, 0, "hot spot"), 1e-9);
    assert_row_at_target(pose_row_of(list, 1, "ÜBER"), 1e-9);
    assert_row_at_target(pose_row_of(list, 2, "3"), 1e-9);
    assert_row_fails(list, 3, "spare", "not set");
    conus_pose_list_destroy(list);
    list = pose_sample_load("localite-instrument.xml", &(conus_pose_options){.axis = CONUS_AXIS_MINUS_X});
    double beam[3];
    const double *m = pose_row_of(list, 0, "hot spot")->pose.world_from_device;
    vec3_sub(beam, m + 12, pose_target);
    assert_near(vec3_dot(beam, m + 8), -80, 1e-9); /* it looks away */
    conus_pose_list_destroy(list);
}

static void localite_triggers_have_times(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("localite-trigger.xml", NULL);
    const conus_pose_row *row = pose_row_of(list, 0, "TMS trigger 0");
    assert_row_at_target(row, 1e-9);
    assert_true(row->trigger);
    assert_near(row->time_s, 1.5, 1e-12);
    assert_row_fails(list, 1, "TMS trigger 1", "not tracked");
    row = pose_row_of(list, 2, "TMS trigger 2");
    assert_row_at_target(row, 1e-9);
    assert_near(row->time_s, 1.9, 1e-12);
    conus_pose_list_destroy(list);
}

#define MATRIX                                                                                                         \
    "<Matrix4D data00=\"0\" data01=\"1\" data02=\"0\" data03=\"-60\" data10=\"0\" data11=\"0\" data12=\"1\" "          \
    "data13=\"0\" data20=\"1\" data21=\"0\" data22=\"0\" data23=\"20\" data30=\"0\" data31=\"0\" data32=\"0\" "        \
    "data33=\"1\"/>"

/* An element that is no marker makes no row, unless it has a matrix. The matrix's first column, along which the coil
 * points, is z. */
static void localite_lists_hold_other_things(void **state)
{
    (void)state;
    conus_pose_list *list =
        parse("<TriggerMarkerList coordinateSpace=\"RAS\"><ResponseParameters selectedResponseChannel=\"0\" "
              "recordingTime=\"x\"><a set=\"false\"/></ResponseParameters><TriggerMarker description=\"a\" "
              "recordingTime=\"1\">" MATRIX "</TriggerMarker><Other description=\"b\">" MATRIX
              "</Other><TriggerMarker description=\"c\"/></TriggerMarkerList>",
              NULL);
    assert_int_equal(conus_pose_list_count(list), 3);
    assert_row_at(pose_row_of(list, 0, "a"), -60, 0, 20);
    assert_row_along(pose_row_of(list, 0, "a"), 0, 0, 1);
    assert_row_at(pose_row_of(list, 1, "b"), -60, 0, 20);
    assert_row_fails(list, 2, "c", "no Matrix4D");
    conus_pose_list_destroy(list);
}

/* MNI is RAS whatever --space says. The marker's attribute set="false" counts where its child does not repeat it. */
static void localite_has_mni(void **state)
{
    (void)state;
    static const char text[] = "<InstrumentMarkerList coordinateSpace=\"MNI\"><InstrumentMarker><Marker "
                               "description=\"a\" set=\"true\">" MATRIX "</Marker></InstrumentMarker>"
                               "<InstrumentMarker set=\"false\"><Marker description=\"b\">" MATRIX
                               "</Marker></InstrumentMarker></InstrumentMarkerList>";
    for (int lps = 0; lps < 2; lps++) {
        conus_pose_list *list = parse(text, &(conus_pose_options){.space = lps ? CONUS_SPACE_LPS : CONUS_SPACE_RAS});
        assert_row_at(pose_row_of(list, 0, "a"), -60, 0, 20);
        assert_row_fails(list, 1, "b", "the marker is not set");
        assert_int_equal(list->space.brain, POSE_BRAIN_MNI152);
        assert_true(pose_has_note(list, "Localite brought these positions"));
        assert_int_equal(pose_has_note(list, "the file says that its positions are RAS"), lps);
        conus_pose_list_destroy(list);
    }
}

static void localite_is_read_strictly(void **state)
{
    (void)state;
    refuse("<Session/>", NULL, "<Session>, allowed are");
    refuse("<InstrumentMarkerList coordinateSpace=\"ASL\"/>", NULL, "coordinateSpace \"ASL\"");
    refuse("<InstrumentMarkerList coordinateSpace=\"RAS\">", NULL, "not well-formed");
    parse_none("<InstrumentMarkerList coordinateSpace=\"RAS\"/>");
    conus_pose_list *list = parse("<InstrumentMarkerList><InstrumentMarker><Marker description=\"a\"><Matrix4D "
                                  "data00=\"x\"/></Marker></InstrumentMarker>"
                                  "<InstrumentMarker description=\"b\"/></InstrumentMarkerList>",
                                  NULL);
    assert_row_fails(list, 0, "a", "data00: \"x\"");
    assert_row_fails(list, 1, "b", "no Matrix4D");
    assert_true(pose_has_note(list, "names no coordinateSpace; taken as RAS"));
    conus_pose_list_destroy(list);
}

static void write_text(const char *path, const char *text)
{
    assert_ok(file_write(path, text, strlen(text)));
}

static void electrodes_are_points(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("electrodes.tsv", NULL);
    assert_int_equal(conus_pose_list_count(list), 6);
    const conus_pose_row *row = pose_row_of(list, 0, "LA2");
    assert_true(row->is_point);
    assert_near(row->pose.world_from_device[12], -26, 0);
    assert_true(pose_has_note(list, "1 rows without coordinates (n/a) passed over, the first in line 5"));
    assert_true(pose_has_note(list, "no *_coordsystem.json"));
    conus_pose_list_destroy(list);
}

/* BIDS says what x, y, z and name are; other columns are of others, whatever they are called. */
static void electrodes_have_the_columns_of_bids(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "id\tname\tx\ty\tz\tCT_x\tCT_y\tCT_z\n7\tA1\t-2\t3\t4\t-42\t-20\t50\n",
        "name\tx\ty\tz\ttarget_x\ttarget_y\ttarget_z\tdepth\nA1\t-2\t3\t4\t-42\tn/a\t50\tdeep\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        conus_pose_list *list = parse(texts[i], NULL);
        const conus_pose_row *row = pose_row_of(list, 0, "A1");
        assert_null(row->error);
        assert_true(row->is_point);
        assert_row_at(row, -2, 3, 4);
        conus_pose_list_destroy(list);
    }
}

/* BEP032's positions are micrometres on the probe, unless a file says which space they are in. */
static void positions_on_a_probe_are_refused(void **state)
{
    (void)state;
    static const char text[] = "name\tprobe_name\tx\ty\tz\nA\tprobe1\t0\t20\t5\n";
    refuse(text, NULL, "column probe_name: a table of BEP032 without a *_coordsystem.json");
    char table[4096];
    snprintf(table, sizeof table, "%s", test_scratch("sub-03_electrodes.tsv"));
    write_text(table, text);
    write_text(test_scratch("sub-03_coordsystem.json"),
               "{\"iEEGCoordinateSystem\":\"ACPC\",\"iEEGCoordinateUnits\":\"mm\"}");
    conus_pose_list *list = NULL;
    assert_ok(conus_pose_list_load(&list, table, NULL));
    assert_near(pose_row_of(list, 0, "A")->pose.world_from_device[13], 20, 0);
    conus_pose_list_destroy(list);
    remove(test_scratch("sub-03_coordsystem.json"));
}

static void contacts_look_along_their_shafts(void **state)
{
    (void)state;
    conus_pose_list *list =
        pose_sample_load("electrodes.tsv", &(conus_pose_options){.along_shafts = true, .all_rows = true});
    static const char *const ids[] = {"LA2", "LA1", "LA10", "", "", "G1", "G2"};
    for (size_t i = 0; i < 7; i++) {
        const double beam[3] = {i < 3 ? -1 : 0, i < 3 ? 0 : 1, 0}; /* LA goes to the left, G forward */
        if (ids[i][0]) {
            const conus_pose_row *row = pose_row_of(list, i, ids[i]);
            assert_null(row->error);
            for (int k = 0; k < 3; k++) {
                assert_near(-row->pose.world_from_device[8 + k], beam[k], 1e-12);
            }
        }
    }
    assert_row_fails(list, 3, "RH1", "x: not known");
    assert_row_fails(list, 4, "RH2", "the only contact of its shaft \"RH\"");
    conus_pose_list_destroy(list);
    refuse("name\tx\ty\tz\tdx\tdy\nA\t0\t0\t0\t0\t0\n", NULL, "only some of the columns dx dy dz"); /* a table */
    refuse("1 2 3\n", &(conus_pose_options){.along_shafts = true},
           "shafts are for electrodes (BIDS: name, x, y, z, size, with tabs, in *_electrodes.tsv), not for points");
    refuse("name\tx\ty\tz\tmni_x\tmni_y\tmni_z\nA1\t1\t2\t3\t1\t2\t3\n", &(conus_pose_options){.along_shafts = true},
           "not for table; --poses-format electrodes reads it as these");
    refuse("name\tx\ty\tz\n", &(conus_pose_options){.axis = CONUS_AXIS_PLUS_Z}, "no axis (+z)");
}

/* Units and space are in a file beside the table, which may hold for several tables. */
static void coordinate_systems_are_found(void **state)
{
    (void)state;
    static const char *const systems[] = {"sub-01_task-x_acq-a_space-MNI152Lin_coordsystem.json",
                                          "sub-01_task-x_space-MNI152Lin_coordsystem.json",
                                          "sub-01_space-MNI152Lin_coordsystem.json", "sub-01_coordsystem.json"};
    enum { SYSTEMS = sizeof systems / sizeof systems[0] };
    static const char json[] = "{\"iEEGCoordinateSystem\":\"MNI152Lin\",\"iEEGCoordinateUnits\":\"cm\"}";
    char table[4096];
    snprintf(table, sizeof table, "%s", test_scratch("sub-01_task-x_acq-a_space-MNI152Lin_electrodes.tsv"));
    write_text(table, "name\tx\ty\tz\tsize\nA1\t-2\t3\t4\t5\n");
    for (size_t i = 0; i <= SYSTEMS; i++) {
        conus_pose_stream *stream = NULL;
        conus_pose_row row;
        size_t count = 0;
        if (i < SYSTEMS) {
            write_text(test_scratch(systems[i]), json);
        }
        assert_ok(conus_pose_stream_open(&stream, table, &(conus_pose_options){.space = CONUS_SPACE_LPS}));
        assert_string_equal(conus_pose_stream_facts(stream).space, "MNI152Lin");
        assert_string_equal(conus_pose_stream_facts(stream).coordsystem, i < SYSTEMS ? test_scratch(systems[i]) : "");
        assert_ok(conus_pose_stream_read(&row, &count, stream, 1));
        assert_near(row.pose.world_from_device[12], i < SYSTEMS ? -20 : -2, 1e-12); /* a named space is RAS */
        assert_non_null(strstr(conus_pose_stream_note(stream, i == SYSTEMS), "positions are RAS"));
        conus_pose_stream_destroy(stream);
        if (i < SYSTEMS) {
            remove(test_scratch(systems[i]));
        }
    }
}

/* A table whose name states a space that is not that of the file beside it: the file's is taken, with a warning, but
 * not "Other", which is none. */
static void a_name_contradicts_its_coordinate_system(void **state)
{
    (void)state;
    static const struct {
        const char *name, *system;
        bool is_told;
    } cases[] = {{"ACPC", "MNI152Lin", true},
                 {"MNI152Lin", "ACPC", true},
                 {"ACPC", "Other", true},
                 {"CapTrak", "MNI152Lin", false},
                 {"CTF", "MNI152Lin", true},
                 {"ACPC", "T1w", false},
                 {"MNI152Lin", "MNI152NLin2009cAsym", false},
                 {"ours", "ACPC", false}};
    char table[4096];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[128];
        snprintf(text, sizeof text, "sub-07_space-%s_electrodes.tsv", cases[i].name);
        snprintf(table, sizeof table, "%s", test_scratch(text));
        write_text(table, "name\tx\ty\tz\nA1\t2\t3\t4\n");
        snprintf(text, sizeof text, "{\"iEEGCoordinateSystem\":\"%s\",\"iEEGCoordinateUnits\":\"mm\"}",
                 cases[i].system);
        write_text(test_scratch("sub-07_coordsystem.json"), text);
        conus_pose_list *list = NULL;
        assert_ok(conus_pose_list_load(&list, table, NULL));
        snprintf(text, sizeof text,
                 strcmp(cases[i].system, "Other") == 0
                     ? "its name says space \"%s\", its coordsystem.json \"%s\": the name is taken"
                     : "its name says space \"%s\", but sub-07_coordsystem.json says \"%s\", which is taken",
                 cases[i].name, cases[i].system);
        assert_int_equal(pose_has_note(list, text), cases[i].is_told);
        conus_pose_list_destroy(list);
    }
    remove(test_scratch("sub-07_coordsystem.json"));
}

/* The space of a *_coordsystem.json. */
static conus_status parse_system(struct pose_space *out, const char *json, const char *modalities)
{
    struct job job = {0};
    *out = pose_coordsystem_parse(&job, text_from(json), modalities);
    return job_close(&job, NULL, NULL);
}

static void coordinate_systems_are_read_strictly(void **state)
{
    (void)state;
    static const struct {
        const char *json, *part;
    } cases[] = {{"{}", "no iEEGCoordinateSystem"},
                 {"[1", "line 1"},
                 {"{\"iEEGCoordinateSystem\":\"Pixels\",\"iEEGCoordinateUnits\":\"pixels\"}", "\"Pixels\" is not"},
                 {"{\"EEGCoordinateSystem\":\"CapTrak\",\"EEGCoordinateUnits\":\"mm\"}", "\"CapTrak\" is not"},
                 {"{\"iEEGCoordinateSystem\":\"ACPC\"}", "CoordinateUnits \"\""},
                 {"{\"iEEGCoordinateSystem\":\"ACPC\",\"iEEGCoordinateUnits\":\"inch\"}", "\"inch\", allowed are mm"}};
    struct pose_space space;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_fails(parse_system(&space, cases[i].json, "iEEG/EEG"), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), cases[i].part));
    }
    assert_ok(parse_system(&space, "{\"iEEGCoordinateSystem\":\"ScanRAS\",\"iEEGCoordinateUnits\":\"m\"}", "iEEG"));
    assert_near(space.scale, 1000, 0);
    assert_int_equal(space.brain, POSE_BRAIN_SUBJECT);
}

/* Names that a *_coordsystem.json has, and those of a table without one. */
static void whose_brain_a_name_means(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum pose_brain brain;
    } cases[] = {{"T1w", POSE_BRAIN_SUBJECT},
                 {"sub-01_ses-2_T1w", POSE_BRAIN_SUBJECT},
                 {"T2w", POSE_BRAIN_SUBJECT},
                 {"Scanner", POSE_BRAIN_SUBJECT},
                 {"individual", POSE_BRAIN_SUBJECT},
                 {"native", POSE_BRAIN_SUBJECT},
                 {"orig", POSE_BRAIN_SUBJECT},
                 {"fsnative", POSE_BRAIN_SUBJECT},
                 {"CT", POSE_BRAIN_SUBJECT},
                 {"tkRAS", POSE_BRAIN_OTHER},
                 {"TkReg", POSE_BRAIN_OTHER},
                 {"sub-01_tkRAS", POSE_BRAIN_OTHER},
                 {"surface RAS", POSE_BRAIN_OTHER},
                 {"surfaceRAS", POSE_BRAIN_OTHER},
                 {"FreeSurferTkReg", POSE_BRAIN_OTHER},
                 {"n/a", POSE_BRAIN_OTHER},
                 {"fsaverage", POSE_BRAIN_MNI305},
                 {"MNIColin27", POSE_BRAIN_COLIN27},
                 {"MNI152NLin6Asym", POSE_BRAIN_MNI152},
                 {"mni152lin", POSE_BRAIN_MNI152},
                 {"Talairach", POSE_BRAIN_TALAIRACH},
                 {"Other", POSE_BRAIN_UNKNOWN},
                 {"our_lab", POSE_BRAIN_UNKNOWN}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char json[128];
        struct pose_space space;
        snprintf(json, sizeof json, "{\"iEEGCoordinateSystem\":\"%s\",\"iEEGCoordinateUnits\":\"mm\"}", cases[i].name);
        assert_ok(parse_system(&space, json, "iEEG"));
        if (space.brain != cases[i].brain) {
            fail_msg("%s: %d", cases[i].name, (int)space.brain);
        }
    }
}

#define RAS_LINE                                                                                                       \
    "{\"type\":\"Line\",\"coordinateSystem\":\"RAS\",\"controlPoints\":[{\"position\":[0,0,9]},{\"position\":[0,0,5]}" \
    "]}"

/* The space that the file states holds; that the caller stated another one is noted once. */
static void a_named_space_wins(void **state)
{
    (void)state;
    conus_pose_list *list =
        parse("{\"markups\":[" RAS_LINE "," RAS_LINE "]}", &(conus_pose_options){.space = CONUS_SPACE_LPS});
    assert_true(pose_has_note(list, "positions are RAS"));
    assert_null(conus_pose_list_note(list, 1));
    conus_pose_list_destroy(list);
}

static void markups_are_lines_and_points(void **state)
{
    (void)state;
    conus_pose_list *list = pose_sample_load("lines.mrk.json", NULL);
    assert_int_equal(conus_pose_list_count(list), 6);
    const conus_pose_row *row = pose_row_of(list, 0, "trajectory left");
    const double entry[3] = {-48, -58.4, 10};
    double way[3];
    vec3_sub(way, pose_target, entry);
    vec3_normalise(way, way);
    for (int i = 0; i < 3; i++) {
        assert_near(row->pose.world_from_device[12 + i], entry[i], 1e-12);
        assert_near(-row->pose.world_from_device[8 + i], way[i], 1e-12);
    }
    assert_row_at_target(pose_row_of(list, 1, "entry"), 1e-12);
    assert_row_fails(list, 2, "half", "a line of 1 points");
    assert_row_fails(list, 3, "cut", "type \"Plane\"");
    row = pose_row_of(list, 4, "F-1");
    assert_true(row->is_point);
    assert_near(row->pose.world_from_device[12], -53.5, 0);
    assert_near(row->pose.world_from_device[13], 73.25, 0);
    assert_row_fails(list, 5, "F-2", "was not placed");
    conus_pose_list_destroy(list);
}

#define LINE                                                                                                           \
    "{\"markups\":[{\"type\":\"Line\",\"coordinateUnits\":\"um\",\"controlPoints\":[{\"position\":[0,0,1000]},"        \
    "{\"position\":[0,0,5000]}]}]}"

static void lines_may_be_looked_along_either_way(void **state)
{
    (void)state;
    conus_pose_list *list = parse(LINE, &(conus_pose_options){.axis = CONUS_AXIS_MINUS_Z});
    const double *m = pose_row_of(list, 0, "1")->pose.world_from_device;
    assert_near(m[14], 5, 1e-12);
    assert_near(-m[10], -1, 1e-12);
    conus_pose_list_destroy(list);
    refuse(LINE, &(conus_pose_options){.axis = CONUS_AXIS_PLUS_X}, "axis +z or -z, not +x");
    refuse("{\"markups\":[{\"type\":\"Fiducial\"}]}", &(conus_pose_options){.axis = CONUS_AXIS_MINUS_Z},
           "no axis (-z)");
    refuse("{\"markups\":7}", NULL, "no list \"markups\"");
    refuse("{\"markups\":[{\"type\":\"Line\",\"coordinateSystem\":\"IJK\"}]}", NULL, "coordinateSystem \"IJK\"");
    refuse("{\"markups\":[{\"type\":\"Line\",\"coordinateUnits\":\"pixel\"}]}", NULL, "coordinateUnits \"pixel\"");
    parse_none("{\"markups\":[]}");
    list = parse("{\"markups\":[7,{\"type\":\"Fiducial\",\"controlPoints\":[{\"position\":[1,2]},{\"position\":"
                 "[1,2,\"3\"]},4]}]}",
                 NULL);
    assert_row_fails(list, 0, "1", "type \"\"");
    assert_row_fails(list, 1, "2", "three numbers");
    assert_row_fails(list, 2, "3", "position: three numbers are needed");
    assert_row_fails(list, 3, "4", "three numbers");
    conus_pose_list_destroy(list);
}

/* A scan and a template are different brains; if one of them does not say which it is, a note does. */
static void spaces_must_fit(void **state)
{
    (void)state;
    conus_atlas *template = NULL;
    conus_atlas *plain = NULL;
    assert_ok(conus_phantom_write("sphere", test_scratch("atlas"), &(conus_phantom_options){.size = 16}));
    char path[4096];
    snprintf(path, sizeof path, "%s/sphere.nii.gz", test_scratch("atlas"));
    assert_ok(conus_atlas_load(&plain, path, NULL));
    struct notes notes = {0};
    const struct pose_space scan = pose_space_named(text_from("NIfTI:Scanner"), POSE_BRAIN_SUBJECT);
    assert_ok(pose_space_match(&notes, &scan, plain));
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "it is not known"));
    notes_finish(&notes);
    const struct pose_space none = {0};
    assert_ok(pose_space_match(&notes, &none, plain));
    assert_int_equal(notes.count, 0);
    const struct pose_space mni = pose_space_named(text_from("MNI152Lin"), POSE_BRAIN_MNI152);
    assert_ok(conus_atlas_move(plain, (const double[16]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}));
    assert_ok(pose_space_match(&notes, &scan, plain)); /* it was moved to where the subject's poses are */
    assert_int_equal(notes.count, 0);
    const struct pose_space surface = pose_space_named(text_from("tkRAS"), POSE_BRAIN_OTHER); /* not the scan's world */
    assert_ok(pose_space_match(&notes, &mni, plain));
    assert_ok(pose_space_match(&notes, &surface, plain));
    assert_int_equal(notes.count, 2);
    assert_non_null(strstr(notes.lines[0], "they must be where the atlas was moved to"));
    assert_non_null(strstr(notes.lines[1], "they must be where the atlas was moved to"));
    notes_finish(&notes);
    plain->brain = CONUS_BRAIN_OWN;
    assert_ok(pose_space_match(&notes, &scan, plain));
    assert_int_equal(notes.count, 0);
    conus_atlas_destroy(plain);
    assert_ok(conus_atlas_load(&template, test_mricron("aal.nii.gz"), NULL));
    assert_fails(pose_space_match(&notes, &scan, template), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "(Colin 27, by its grid)"));
    assert_ok(pose_space_match(&notes, &mni, template));
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "the atlas is Colin 27, by its grid: areas differ by some mm"));
    notes_finish(&notes);
    conus_atlas_destroy(template);
}

/* What becomes of positions in each space on each brain: nothing is said, a note, a warning, or they are refused. */
static void each_brain_against_each(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum pose_brain brain;
        const char *wanted; /* on an unknown one, one person's own, MNI 152, Colin 27, MNI 305, Talairach, another */
    } cases[] = {{"NIfTI:Scanner", POSE_BRAIN_SUBJECT, "w-xxxxx"},
                 {"tkRAS", POSE_BRAIN_OTHER, "xxxxxxx"},
                 {"n/a", POSE_BRAIN_OTHER, "wwxxxxx"},
                 {"NIfTI:Aligned", POSE_BRAIN_UNKNOWN, "wwwwwww"},
                 {"MNI152Lin", POSE_BRAIN_MNI152, "wx-nwxw"},
                 {"MNIColin27", POSE_BRAIN_COLIN27, "wxn-wxw"},
                 {"fsaverage", POSE_BRAIN_MNI305, "wxww-xw"},
                 {"Talairach", POSE_BRAIN_TALAIRACH, "wxxxx-w"},
                 {"fsLR", POSE_BRAIN_TEMPLATE, "wxwwwww"},
                 {"", POSE_BRAIN_UNKNOWN, "-------"}};
    conus_atlas *atlas = NULL;
    char path[4096];
    assert_ok(conus_phantom_write("sphere", test_scratch("each"), &(conus_phantom_options){.size = 16}));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", test_scratch("each"));
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct pose_space space = pose_space_named(text_from(cases[i].name), cases[i].brain);
        for (int brain = CONUS_BRAIN_UNKNOWN; brain <= CONUS_BRAIN_TEMPLATE; brain++) {
            struct notes notes = {0};
            atlas->brain = (conus_brain)brain;
            conus_status status = pose_space_match(&notes, &space, atlas);
            char found = status                                              ? 'x'
                         : !notes.count                                      ? '-'
                         : notes.marks[0].severity == CONUS_SEVERITY_WARNING ? 'w'
                                                                             : 'n';
            if (found != cases[i].wanted[brain]) {
                fail_msg("%s on %d: %c", cases[i].name, brain, found);
            }
            notes_finish(&notes);
        }
    }
    /* tkRAS is scanner RAS where c_ras, the point with index dim / 2, is 0 */
    const struct pose_space surface = pose_space_named(text_from("tkRAS"), POSE_BRAIN_OTHER);
    double *m = atlas->volumes[0].info.world_from_voxel;
    memcpy(m, (const double[16]){-1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 8, -8, 8, 1}, 16 * sizeof *m);
    for (int k = 0; k < 3; k++) {
        struct notes notes = {0};
        atlas->brain = CONUS_BRAIN_OWN;
        m[12 + k] += 0.009;
        assert_ok(pose_space_match(&notes, &surface, atlas));
        assert_int_equal(notes.count, 1);
        assert_non_null(strstr(notes.lines[0], "c_ras is 0 by the grid of the atlas"));
        atlas->brain = CONUS_BRAIN_UNKNOWN;
        assert_ok(pose_space_match(&notes, &surface, atlas));
        assert_int_equal(notes.count, 2);
        assert_non_null(strstr(notes.lines[1], "it is not known"));
        m[12 + k] += 5;
        assert_fails(pose_space_match(&notes, &surface, atlas), CONUS_ERROR_DATA);
        assert_non_null(strstr(conus_message(), (const char *const[]){"(5.01, 0.00, 0.00) mm", "(0.00, 5.01, 0.00) mm",
                                                                      "(0.00, 0.00, 5.01) mm"}[k]));
        m[12 + k] -= 5.009;
        notes_finish(&notes);
    }
    conus_atlas_destroy(atlas);
}

/* NLin2009 and the editions before it lie some mm apart; an edition that is not known is not held against anybody. */
static void editions_are_told_apart(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int warnings[3]; /* on an edition that is not known, an earlier one, NLin2009 */
    } cases[] = {{"MNI152NLin2009cAsym", {0, 1, 0}},
                 {"MNI152NLin6Asym", {0, 0, 1}},
                 {"MNI152Lin", {0, 0, 1}},
                 {"NIfTI:MNI-152", {0, 0, 0}}};
    static const size_t dims[3][3] = {{16, 16, 16}, {182, 218, 182}, {193, 229, 193}};
    static const double lows[3][3] = {{0, 0, 0}, {-91, -126, -72}, {-96, -132, -78}};
    conus_atlas *atlas = NULL;
    char path[4096];
    assert_ok(conus_phantom_write("sphere", test_scratch("editions"), &(conus_phantom_options){.size = 16}));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", test_scratch("editions"));
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    conus_volume_info *info = &atlas->volumes[0].info;
    const conus_volume_info before = *info;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct pose_space space = pose_space_named(text_from(cases[i].name), POSE_BRAIN_MNI152);
        for (size_t k = 0; k < 3; k++) {
            struct notes notes = {0};
            info->space_code = 4;
            memcpy(info->dim, dims[k], sizeof info->dim);
            for (int axis = 0; axis < 3; axis++) {
                info->world_from_voxel[5 * axis] = 1;
                info->world_from_voxel[12 + axis] = lows[k][axis];
            }
            assert_ok(pose_space_match(&notes, &space, atlas));
            assert_int_equal(notes.count, cases[i].warnings[k]);
            assert_true(!notes.count || notes.marks[0].severity == CONUS_SEVERITY_WARNING);
            notes_finish(&notes);
        }
    }
    *info = before;
    conus_atlas_destroy(atlas);
}

/* Localite's RAS and LPS are of the scan that was loaded, and so are lists without a word; MNI is not. */
static void localite_says_whose_brain(void **state)
{
    (void)state;
    static const struct {
        const char *space, *name;
        enum pose_brain brain;
    } cases[] = {{" coordinateSpace=\"RAS\"", "Localite RAS", POSE_BRAIN_SUBJECT},
                 {" coordinateSpace=\"lps\"", "Localite LPS", POSE_BRAIN_SUBJECT},
                 {"", "Localite, no coordinateSpace", POSE_BRAIN_SUBJECT},
                 {" coordinateSpace=\"MNI\"", "Localite MNI", POSE_BRAIN_MNI152}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "<InstrumentMarkerList%s></InstrumentMarkerList>", cases[i].space);
        conus_pose_list list = {0};
        struct job job = {0};
        struct pose_reading reading = {.job = &job, .list = &list, .options = &(conus_pose_options){0}};
        pose_localite_parse(&reading, text_from(text));
        assert_ok(job_close(&job, NULL, NULL));
        assert_string_equal(list.space.name, cases[i].name);
        assert_int_equal(list.space.brain, cases[i].brain);
        pose_list_finish(&list);
    }
}

struct heard {
    size_t count;
    conus_severity severity; /* of the last */
    char path[4096], line[512];
};

static void hear(void *user, const conus_note *note)
{
    struct heard *heard = user;
    heard->count++;
    heard->severity = note->severity;
    snprintf(heard->path, sizeof heard->path, "%s", note->path);
    snprintf(heard->line, sizeof heard->line, "%s", note->line);
}

static void assert_heard(const struct heard *heard, size_t count, conus_severity severity, const char *path,
                         const char *part)
{
    assert_int_equal(heard->count, count);
    assert_int_equal(heard->severity, severity);
    assert_string_equal(heard->path, path);
    assert_non_null(strstr(heard->line, part));
}

/* Notes are heard at once, also those of a refused file and of later calls on a list or stream, and none twice. */
static void notes_are_heard(void **state)
{
    (void)state;
    static const char zero_byte[] = "name\tx\ty\tz\tsize\nA1\t1\t2\t3\t\0\n";
    struct heard heard = {0};
    const conus_pose_options options = {.log = hear, .log_user = &heard};
    conus_pose_stream *stream = NULL;
    conus_pose_list *list = NULL;
    conus_atlas *atlas = NULL;
    char path[4096];
    assert_ok(conus_phantom_write("sphere", test_scratch("heard"), &(conus_phantom_options){.size = 16}));
    snprintf(path, sizeof path, "%s/sphere.nii.gz", test_scratch("heard"));
    assert_ok(conus_atlas_load(&atlas, path, NULL));

    snprintf(path, sizeof path, "%s", pose_sample("brainsight.txt"));
    assert_ok(conus_pose_list_load(&list, path, &options));
    assert_heard(&heard, 1, CONUS_SEVERITY_NOTE, path, "2 rows of landmarks");
    assert_ok(conus_pose_list_match(list, atlas));
    assert_heard(&heard, 2, CONUS_SEVERITY_WARNING, path, "it is not known whether the atlas");
    assert_null(conus_pose_list_note(list, 2));
    conus_pose_list_destroy(list);
    heard.count = 0;
    assert_ok(conus_pose_stream_open(&stream, path, &options));
    assert_ok(conus_pose_stream_match(stream, atlas));
    assert_heard(&heard, 2, CONUS_SEVERITY_WARNING, path, "it is not known whether the atlas");
    conus_pose_stream_destroy(stream);
    conus_atlas_destroy(atlas);

    heard.count = 0;
    snprintf(path, sizeof path, "%s", test_scratch("zero_electrodes.tsv"));
    assert_ok(file_write(path, zero_byte, sizeof zero_byte - 1));
    assert_fails(conus_pose_stream_open(&stream, path, &options), CONUS_ERROR_DATA);
    assert_heard(&heard, 1, CONUS_SEVERITY_WARNING, path, "no *_coordsystem.json beside it");
}

static const char *const samples[] = {
    "brainsight.txt", "brainsight-world.txt", "localite-instrument.xml", "localite-trigger.xml",
    "electrodes.tsv", "lines.mrk.json",       "fiducials.fcsv",          "points.txt"};

/* Of each format a file whose second and third pose have the name of the first. */
static void equal_names_are_noted(void **state)
{
    (void)state;
    static const char markup[] =
        "{\"type\":\"Fiducial\",\"coordinateSystem\":\"RAS\",\"controlPoints\":[{\"label\":\"a\","
        "\"position\":[1,2,3]},{\"label\":\"b\",\"position\":[1,2,3]}]}";
    char markups[1024];
    snprintf(markups, sizeof markups, "{\"markups\":[%s,%s]}", markup, markup);
    const struct {
        const char *text, *note; /* NULL: there is none */
    } files[] = {
        {"id,x,y,z,tx,ty,tz\na,0,0,90,0,0,0\nb,0,0,90,0,0,0\na,0,0,80,0,0,0\na,0,0,70,0,0,0\n",
         "poses 1 and 3 are both called \"a\"; 2 of 4 have"},
        {"1 2 3 a\n1 2 3 a\n1 2 3 b\n1 2 3 b\n", "poses 1 and 2 are both called \"a\"; 2 of 4 have"},
        {"id,x,y,z,tx,ty,tz\n2,0,0,90,0,0,0\n,0,0,80,0,0,0\n",
         "poses 1 and 2 are both called \"2\"; 1 of 2 have"}, /* the second is called so by its row */
        {"id,x,y,z,tx,ty,tz\n2,0,0,90,0,0,0\n1,0,0,80,0,0,0\n", NULL},
        {"1 2 3\n1 2 3\n", NULL},
        {"name\tx\ty\tz\n1\t1\t2\t3\n1\t4\t5\t6\n", "poses 1 and 2 are both called \"1\"; 1 of 2 have"},
        {"# Markups fiducial file version = 4.11\n# CoordinateSystem = 0\n# columns = "
         "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,"
         "label\nn,1,2,3,0,0,0,1,1,1,0,a\nm,1,2,3,0,0,0,1,1,1,0,a\n",
         "poses 1 and 2 are both called \"a\"; 1 of 2 have"},
        {markups, "poses 1 and 3 are both called \"a\"; 2 of 4 have"},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        conus_pose_list *list = parse(files[i].text, NULL);
        assert_true(files[i].note ? pose_has_note(list, files[i].note) : !pose_has_note(list, "are both called"));
        conus_pose_list_destroy(list);
    }
}

static void check_prefix(const conus_pose_list *whole, struct text prefix)
{
    conus_pose_list *list = NULL;
    if (pose_list_parse(&list, prefix, NULL) == CONUS_OK) {
        size_t count = conus_pose_list_count(list);
        assert_true(count <= conus_pose_list_count(whole));
        for (size_t i = 0; i + 1 < count; i++) {
            bool same = !conus_pose_list_row(list, i)->error == !conus_pose_list_row(whole, i)->error;
            assert_true(same);
        }
    }
    conus_pose_list_destroy(list);
}

/* A file that is cut off is refused or gives the first of its rows, the last of them perhaps with an error. */
static void every_prefix_is_refused_or_shorter(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof samples / sizeof samples[0]; k++) {
        struct bytes bytes = {0};
        conus_pose_list *whole = pose_sample_load(samples[k], NULL);
        assert_ok(file_read(&bytes, pose_sample(samples[k]), 1 << 20));
        for (size_t size = 0; size < bytes.size; size++) {
            char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
            memcpy(exact, bytes.data, size);
            check_prefix(whole, (struct text){exact, size});
            free(exact);
        }
        conus_pose_list_destroy(whole);
        bytes_finish(&bytes);
    }
}

static conus_status load_sample(void *path)
{
    conus_pose_list *list = NULL;
    const conus_pose_options shafts = {.along_shafts = true};
    conus_status status = conus_pose_list_load(&list, path, strstr(path, "electrodes") ? &shafts : NULL);
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
    char table[4096];
    snprintf(table, sizeof table, "%s", test_scratch("sub-02_electrodes.tsv"));
    write_text(table, "name\tx\ty\tz\tsize\nA1\t-2\t3\t4\t5\nA2\t-2\t3\t5\t5\n");
    write_text(test_scratch("sub-02_coordsystem.json"),
               "{\"iEEGCoordinateSystem\":\"Other\",\"iEEGCoordinateUnits\":\"mm\"}");
    test_every_allocation(load_sample, table);
}

TEST_GROUP(pose_files)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brainsight_targets_samples_electrodes),
        cmocka_unit_test(brainsight_world_is_lps),
        cmocka_unit_test(brainsight_names_spaces_and_units),
        cmocka_unit_test(brainsight_is_read_strictly),
        cmocka_unit_test(names_are_whole_or_refused),
        cmocka_unit_test(localite_markers_look_along_x),
        cmocka_unit_test(localite_triggers_have_times),
        cmocka_unit_test(localite_lists_hold_other_things),
        cmocka_unit_test(localite_has_mni),
        cmocka_unit_test(localite_is_read_strictly),
        cmocka_unit_test(electrodes_are_points),
        cmocka_unit_test(electrodes_have_the_columns_of_bids),
        cmocka_unit_test(positions_on_a_probe_are_refused),
        cmocka_unit_test(contacts_look_along_their_shafts),
        cmocka_unit_test(coordinate_systems_are_found),
        cmocka_unit_test(a_name_contradicts_its_coordinate_system),
        cmocka_unit_test(coordinate_systems_are_read_strictly),
        cmocka_unit_test(whose_brain_a_name_means),
        cmocka_unit_test(a_named_space_wins),
        cmocka_unit_test(markups_are_lines_and_points),
        cmocka_unit_test(lines_may_be_looked_along_either_way),
        cmocka_unit_test(spaces_must_fit),
        cmocka_unit_test(each_brain_against_each),
        cmocka_unit_test(editions_are_told_apart),
        cmocka_unit_test(localite_says_whose_brain),
        cmocka_unit_test(notes_are_heard),
        cmocka_unit_test(equal_names_are_noted),
        cmocka_unit_test(every_prefix_is_refused_or_shorter),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
