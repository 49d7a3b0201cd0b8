/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports on the contacts of probes: their columns, the draft BEP032, the strings of SpikeGLX and Open Ephys. */
#include "conus/own.h"
#include "poses/programs/pose_programs.h"
#include "report_scene.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Four blocks of 10 mm along x, from -20 mm on: 1 and 2 are parts of A, 3 of B, and both of All; 4 is in none. */
static conus_atlas *make_atlas(void)
{
    static uint8_t values[40];
    static const conus_label labels[] = {{.number = 1, .name = "One_L", .parent = 11},
                                         {.number = 2, .name = "Two", .parent = 11},
                                         {.number = 3, .name = "Three", .parent = 12},
                                         {.number = 4, .name = "Four"},
                                         {.number = 11, .name = "A", .parent = 13},
                                         {.number = 12, .name = "B", .parent = 13},
                                         {.number = 13, .name = "All"}};
    for (size_t i = 0; i < sizeof values; i++) {
        values[i] = (uint8_t)(i / 10 + 1);
    }
    conus_atlas *atlas = NULL;
    const conus_voxels voxels = {.data = values,
                                 .type = CONUS_SCALAR_UINT8,
                                 .dim = {40, 1, 1},
                                 .world_from_voxel = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -19.5, 0, 0, 1},
                                 .name = "blocks"};
    assert_ok(conus_atlas_create(&atlas, &voxels, labels, sizeof labels / sizeof labels[0], NULL));
    return atlas;
}

/* Two probes; the shanks of the first are called 1 and 0, and its contacts are wired from the last to the first. */
static const char text[] = "{\"specification\":\"probeinterface\",\"probes\":[{\"ndim\":2,\"si_units\":\"mm\","
                           "\"contact_positions\":[[0,1],[0,11],[9,3],[9,2]],\"shank_ids\":[\"1\",\"1\",\"0\",\"0\"],"
                           "\"device_channel_indices\":[3,2,-1,0],\"probe_planar_contour\":[[0,0],[9,20],[-9,20]]},"
                           "{\"ndim\":3,\"si_units\":\"um\",\"contact_positions\":[[1,2,3],[4,5,6]],"
                           "\"probe_planar_contour\":[[0,0,0],[9,20,0],[-9,20,0]]}]}";

struct asked {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_probe *probe;
    conus_selection *at[6];
    conus_report_options options;
};

/* The contacts lie in areas 1, 2, 3, 2 and 4, 4. */
static struct asked ask(void)
{
    static const double x[6] = {-15, -5, 5, -1, 15, 12};
    struct asked asked = {.atlas = make_atlas()};
    assert_ok(conus_selector_create(&asked.selector, asked.atlas, NULL));
    assert_ok(probe_parse(&asked.probe, text_from(text), NULL));
    for (int i = 0; i < 6; i++) {
        assert_ok(conus_select_ball(&asked.at[i], asked.selector, (double[]){x[i], 0, 0}, 1e-3));
    }
    return asked;
}

static void finish(struct asked *asked)
{
    for (int i = 0; i < 6; i++) {
        conus_selection_destroy(asked->at[i]);
    }
    conus_selector_destroy(asked->selector);
    conus_probe_destroy(asked->probe);
    conus_atlas_destroy(asked->atlas);
}

static conus_report *report_of(const struct asked *asked, const char *format, int count)
{
    conus_report *report = NULL;
    const conus_report_options options = {.format = format, .probe = asked->probe};
    assert_ok(conus_report_create(&report, asked->selector, &options));
    for (int i = 0; i < count; i++) {
        assert_ok(conus_report_add(report, conus_probe_at(asked->probe, (size_t)i)->id, asked->at[i]));
    }
    return report;
}

static void assert_text(const struct asked *asked, const char *format, const char *wanted)
{
    const char *found = NULL;
    size_t size = 0;
    conus_report *report = report_of(asked, format, 6);
    assert_ok(conus_report_text(&found, &size, report));
    assert_string_equal(found, wanted);
    conus_report_destroy(report);
}

/* The world is RAS; AP of the CCF grows along z and ML against x, in micrometres. Bregma lies 2 mm behind the corner.
 */
static void make_frame(conus_frame *frame)
{
    static const double ccf[16] = {0, 0, 1e-3, 0, 0, -1e-3, 0, 0, -1e-3, 0, 0, 0, 0, 0, -2, 1};
    static const double bregma[16] = {0, 0, -1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -2, 1};
    static const double bregma_in_ccf[3] = {5400, 332.5, 5739};
    for (size_t i = 0; i < 16; i += 5) {
        frame->world_from_space[i] = frame->space == CONUS_SPACE_LPS && i < 10 ? -1 : 1;
    }
    if (frame->space >= CONUS_SPACE_CCF) {
        memcpy(frame->world_from_space, frame->space == CONUS_SPACE_CCF ? ccf : bregma, sizeof ccf);
        memcpy(frame->bregma, bregma_in_ccf, sizeof bregma_in_ccf);
    }
}

/* A row starts with the position and ends with the area and its side. */
static void electrodes_of_the_draft(void **state)
{
    (void)state;
    struct asked asked = ask();
    static const char *const rows[] = {
        "name\tprobe_name\tx\ty\tz\themisphere\tshank_id\tanatomical_location\tanatomical_location_id\tlocal",
        "probe1:0\tprobe1\t0\t1000\tn/a\tL\t1\tOne_L\tn/a\tconus ",
        "probe1:2\tprobe1\t9000\t3000\tn/a\tR\t0\tThree\tn/a\tconus ",
        "probe2:1\tprobe2\t4\t5\t6\tR\tn/a\tFour\tn/a\tconus "};
    const char *found = NULL;
    size_t size = 0;
    conus_report *report = report_of(&asked, "bep032", 6);
    assert_ok(conus_report_text(&found, &size, report));
    for (size_t i = 0; i < 4; i++) {
        assert_non_null(strstr(found, rows[i]));
    }
    size_t lines = 0;
    for (const char *at = found; (at = strchr(at, '\n')); at++) {
        lines++;
    }
    assert_int_equal(lines, 7);
    assert_ok(conus_report_sidecar(&found, &size, report));
    assert_non_null(strstr(found, "draft BEP032"));
    assert_non_null(strstr(found, "\"anatomical_location\": {"));
    conus_report_destroy(report);
    finish(&asked);
}

/* Positions in LPS replace those on the probe, with the units and words of each space. */
static void electrodes_in_a_space(void **state)
{
    (void)state;
    static const struct {
        conus_frame frame;
        const char *row, *system, *words, *units;
    } spaces[] = {
        {{.space = CONUS_SPACE_RAS}, "probe1:0\tprobe1\t-15\t0\t0\tL\t", "Other", "x grows to the right", "mm"},
        {{.space = CONUS_SPACE_LPS}, "probe1:0\tprobe1\t15\t0\t0\tL\t", "Other", "x grows to the left", "mm"},
        {{.space = CONUS_SPACE_CCF},
         "probe1:0\tprobe1\t2000\t0\t15000\tL\t",
         "AllenCCFv3",
         "(AP) grows to posterior",
         "um"},
        {{.space = CONUS_SPACE_BREGMA},
         "probe1:0\tprobe1\t-2\t-15\t0\tL\t",
         "Other",
         "at AP 5400, DV 332.5, ML 5739 um",
         "mm"}};
    struct asked asked = ask();
    for (size_t i = 0; i < sizeof spaces / sizeof spaces[0]; i++) {
        conus_frame frame = spaces[i].frame;
        conus_report_options options = {.format = "bep032", .probe = asked.probe, .placed = true};
        conus_report *report = NULL;
        const char *found = NULL;
        char wanted[64];
        size_t size = 0;
        make_frame(&frame);
        options.frame = &frame;
        assert_ok(conus_report_create(&report, asked.selector, &options));
        assert_ok(conus_report_add(report, "probe1:0", asked.at[0]));
        assert_ok(conus_report_add_error(report, "probe1:1", 0, "nowhere"));
        assert_ok(conus_report_text(&found, &size, report));
        assert_non_null(strstr(found, spaces[i].row));
        assert_non_null(strstr(found, "\nprobe1:1\tn/a\tn/a\tn/a\tn/a\t"));
        assert_ok(conus_report_sidecar(&found, &size, report));
        snprintf(wanted, sizeof wanted, "\"Units\": \"%s\"\n },\n \"y\": {", spaces[i].units);
        assert_non_null(strstr(found, wanted));
        assert_ok(conus_report_coordsystem(&found, &size, report));
        assert_int_equal(strlen(found), size);
        snprintf(wanted, sizeof wanted, "{\n \"MicroephysCoordinateSystem\": \"%s\",\n", spaces[i].system);
        assert_ptr_equal(strstr(found, wanted), found);
        assert_non_null(strstr(found, spaces[i].words));
        snprintf(wanted, sizeof wanted, "\n \"MicroephysCoordinateUnits\": \"%s\"\n}\n", spaces[i].units);
        assert_string_equal(strstr(found, "\n \"MicroephysCoordinateUnits"), wanted);
        conus_report_destroy(report);
    }
    conus_report *report = report_of(&asked, "bep032", 6);
    const char *found = NULL;
    size_t size = 0;
    assert_fails(conus_report_coordsystem(&found, &size, report), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    const conus_report_options elsewhere = {.format = "tsv", .probe = asked.probe, .placed = true};
    assert_fails(conus_report_create(&report, asked.selector, &elsewhere), CONUS_ERROR_ARGUMENT);
    finish(&asked);
}

/* One, Two and Three are in A and B, which are both in All. */
static void the_smallest_area_has_all_contacts(void **state)
{
    (void)state;
    struct asked asked = ask();
    const char *found = NULL;
    size_t size = 0;
    conus_report *report = report_of(&asked, "bep032", 6);
    assert_ok(conus_report_probes(&found, &size, report));
    assert_string_equal(found, "probe_name\ttype\themisphere\tanatomical_location\tanatomical_location_id\n"
                               "probe1\tn/a\tn/a\tAll\tn/a\nprobe2\tn/a\tR\tFour\tn/a\n");
    assert_fails(conus_report_add(report, "more", asked.at[0]), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    report = report_of(&asked, "bep032", 5);
    assert_fails(conus_report_probes(&found, &size, report), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_report_add_error(report, "probe2:1", 0, "nowhere"));
    assert_ok(conus_report_probes(&found, &size, report));
    assert_non_null(strstr(found, "\nprobe2\tn/a\tn/a\tn/a\tn/a\n"));
    assert_ok(conus_report_text(&found, &size, report));
    assert_non_null(strstr(found, "\nprobe2:1\tn/a\tn/a"));
    conus_report_destroy(report);
    report = report_of(&asked, "tsv", 6);
    assert_fails(conus_report_probes(&found, &size, report), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    finish(&asked);
}

/* On the first probe channel 0 is the contact at x = -1, and 2 and 3 are those at -5 and -15. The second probe has the
 * file's order. */
static void strings_follow_shanks_and_channels(void **state)
{
    (void)state;
    struct asked asked = ask();
    char wanted[512];
    char colours[5][2][32];
    for (size_t i = 1; i < 5; i++) {
        const uint8_t *rgb = conus_atlas_object(asked.atlas, i)->rgb;
        snprintf(colours[i][0], sizeof colours[i][0], "%02X%02X%02X", rgb[0], rgb[1], rgb[2]);
        snprintf(colours[i][1], sizeof colours[i][1], "%d,%d,%d", rgb[0], rgb[1], rgb[2]);
    }
    snprintf(wanted, sizeof wanted, "0-0,Two,%s;2-2,Two,%s;3-3,One_L,%s\n0-1,Four,%s\n", colours[2][0], colours[2][0],
             colours[1][0], colours[4][0]);
    assert_text(&asked, "open-ephys", wanted);
    snprintf(wanted, sizeof wanted,
             "[0,0](2000,2500,%s,Two)(2500,3000,%s,Three)\n[0,1](1000,6000,%s,One_L)(6000,11000,%s,Two)\n"
             "[1,0](2,5,%s,Four)\n",
             colours[2][1], colours[3][1], colours[1][1], colours[2][1], colours[4][1]);
    assert_text(&asked, "spikeglx", wanted);
    finish(&asked);
}

/* The CCF's grid, all of which is area 385; the last contact lies half a micrometre outside of it. */
static void the_allen_atlas_has_ids_and_sides(void **state)
{
    (void)state;
    static const double at[6][3] = {{5, 3, 2}, {5, 3, 9}, {6, 3, 2}, {7, 3, 2}, {5, 3, 9}, {5, 3, -0.1005}};
    static const conus_label labels[] = {{.number = 385, .name = "Primary visual area", .parent = 997},
                                         {.number = 997, .name = "root"}};
    uint16_t *values = malloc(sizeof *values * 66 * 40 * 57);
    struct asked asked = {0};
    const char *found = NULL;
    size_t size = 0;
    for (size_t i = 0; i < (size_t)66 * 40 * 57; i++) {
        values[i] = 385;
    }
    const conus_voxels voxels = {.data = values,
                                 .type = CONUS_SCALAR_UINT16,
                                 .dim = {66, 40, 57},
                                 .world_from_voxel = {0.2, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 1},
                                 .name = "atlases/allen_mouse_200um/annotation"};
    assert_ok(conus_atlas_create(&asked.atlas, &voxels, labels, 2, NULL));
    free(values);
    assert_ok(conus_selector_create(&asked.selector, asked.atlas, NULL));
    assert_ok(probe_parse(&asked.probe, text_from(text), NULL));
    for (int i = 0; i < 6; i++) {
        assert_ok(conus_select_ball(&asked.at[i], asked.selector, at[i], 1e-3));
    }
    conus_report *report = report_of(&asked, "bep032", 6);
    assert_ok(conus_report_text(&found, &size, report));
    assert_non_null(strstr(found, "probe1:0\tprobe1\t0\t1000\tn/a\tL\t1\tPrimary visual area\tMBA:385\t"));
    assert_non_null(strstr(found, "probe1:1\tprobe1\t0\t11000\tn/a\tR\t1\tPrimary visual area\tMBA:385\t"));
    assert_non_null(strstr(found, "probe2:1\tprobe2\t4\t5\t6\tL\tn/a\tn/a\tn/a\t"));
    assert_ok(conus_report_probes(&found, &size, report));
    assert_non_null(strstr(found, "\nprobe1\tn/a\tn/a\tPrimary visual area\tMBA:385\nprobe2\tn/a\tn/a\tn/a\tn/a\n"));
    conus_report_destroy(report);
    finish(&asked);
}

/* The contact comes before its place, in answers and in summaries. */
static void columns_have_one_order(void **state)
{
    (void)state;
    struct asked asked = ask();
    const char *const rows[] = {"answers", "summaries"};
    for (size_t i = 0; i < 2; i++) {
        conus_report *report = NULL;
        const char *found = NULL;
        size_t size = 0;
        const conus_report_options options = {.rows = rows[i], .format = "tsv", .probe = asked.probe, .points = true};
        assert_ok(conus_report_create(&report, asked.selector, &options));
        assert_ok(conus_report_text(&found, &size, report));
        assert_non_null(strstr(found, "\tprobe\tshank_id\tchannel\tx\ty\tz\n"));
        conus_report_destroy(report);
    }
    finish(&asked);
}

static void only_answers_to_contacts_are_taken(void **state)
{
    (void)state;
    struct asked asked = ask();
    conus_report *report = NULL;
    conus_batch *batch = NULL;
    conus_report_options options = {.format = "bep032"};
    assert_fails(conus_report_create(&report, asked.selector, &options), CONUS_ERROR_ARGUMENT);
    options = (conus_report_options){.rows = "segments", .format = "tsv", .probe = asked.probe};
    assert_fails(conus_report_create(&report, asked.selector, &options), CONUS_ERROR_ARGUMENT);
    const conus_batch_options many = {.report = {.format = "tsv", .probe = asked.probe}};
    assert_fails(conus_batch_create(&batch, asked.selector, &many), CONUS_ERROR_ARGUMENT);
    finish(&asked);
}

static conus_status report_all(void *data)
{
    const struct asked *asked = data;
    conus_report *report = NULL;
    const char *found = NULL;
    size_t size = 0;
    conus_status status = conus_report_create(&report, asked->selector, &asked->options);
    for (size_t i = 0; i < 6 && !status; i++) {
        status = conus_report_add(report, conus_probe_at(asked->probe, i)->id, asked->at[i]);
    }
    status = status ? status : conus_report_text(&found, &size, report);
    if (!status && strcmp(asked->options.format, "bep032") == 0) {
        status = conus_report_probes(&found, &size, report);
    }
    status = status ? status : conus_report_sidecar(&found, &size, report);
    conus_report_destroy(report);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct asked asked = ask();
    static const char *const formats[] = {"tsv", "spikeglx", "open-ephys", "bep032"};
    for (size_t i = 0; i < 4; i++) {
        asked.options = (conus_report_options){.format = formats[i], .probe = asked.probe};
        test_every_allocation(report_all, &asked);
    }
    finish(&asked);
}

TEST_GROUP(report_probe)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(electrodes_of_the_draft),
        cmocka_unit_test(electrodes_in_a_space),
        cmocka_unit_test(the_smallest_area_has_all_contacts),
        cmocka_unit_test(strings_follow_shanks_and_channels),
        cmocka_unit_test(the_allen_atlas_has_ids_and_sides),
        cmocka_unit_test(columns_have_one_order),
        cmocka_unit_test(only_answers_to_contacts_are_taken),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
