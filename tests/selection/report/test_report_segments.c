/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports on the segments of axes: the table for people, and shanks for SpikeGLX and Open Ephys, in boxes inside each
 * other. */
#include "atlas/atlas.h"
#include "conus/report.h"
#include "mesh_scene.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Adds a box from x = low to high, named by its number, with 10 times it as colour. */
static void add_box(conus_atlas *atlas, double low, double high)
{
    struct mesh box = mesh_scene_box((const double[]){low, -50, -50}, (const double[]){high, 50.5, 50.25});
    mesh_scene_add(atlas, &box);
    conus_object *object = &atlas->objects[atlas->object_count - 1];
    memset(object->rgb, (int)(10 * atlas->object_count), sizeof object->rgb);
}

struct made {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_table *segments;
    conus_report *report;
};

/* An axis along x from 0, through a box from 10 to 40 mm, boxes in it from 20 to 30 and from 20 to 25 mm, and one from
 * 38 to 44 mm, which overlaps the first. */
static struct made make(const conus_report_options *options, double far)
{
    struct made made = {.atlas = mesh_scene_atlas()};
    conus_pose pose;
    add_box(made.atlas, 10, 40);
    add_box(made.atlas, 20, 30);
    add_box(made.atlas, 20, 25);
    add_box(made.atlas, 38, 44);
    assert_ok(conus_pose_along(&pose, (const double[]){0, 0.1, 0.2}, (const double[]){1, 0, 0}, NULL));
    conus_frame frame;
    assert_ok(conus_frame_find(&frame, NULL, options->space, NULL));
    assert_ok(conus_selector_create(&made.selector, made.atlas,
                                    &(conus_selector_options){.range = {0, far}, .frame = &frame}));
    assert_ok(conus_segments(&made.segments, made.selector, &pose));
    assert_ok(conus_report_create(&made.report, made.selector, options));
    assert_ok(conus_report_add_table(made.report, "a", made.segments));
    return made;
}

static void destroy(struct made *made)
{
    conus_report_destroy(made->report);
    conus_table_destroy(made->segments);
    conus_selector_destroy(made->selector);
    conus_atlas_destroy(made->atlas);
}

static const char *text_of(conus_report *report)
{
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_text(&text, &size, report));
    assert_int_equal(strlen(text), size);
    return text;
}

/* Each depth has one area: the one entered last. From 20 to 25 mm, where two begin, it is the one that ends first; from
 * 38 to 40 mm the last box. Heights are from the tip at 50 mm. */
static void the_innermost_of_nested_areas_counts(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.format = "spikeglx"}, 50);
    char wanted[512] = "[0,0]";
    static const int regions[][3] = {{4, 6, 12}, {1, 12, 20}, {2, 20, 25}, {3, 25, 30}, {1, 30, 40}};
    for (size_t i = 0; i < 5; i++) {
        size_t used = strlen(wanted);
        int rgb = 10 * regions[i][0];
        snprintf(wanted + used, sizeof wanted - used, "(%d,%d,%d,%d,%d,%s)", 1000 * regions[i][1], 1000 * regions[i][2],
                 rgb, rgb, rgb, made.atlas->objects[regions[i][0] - 1].name);
    }
    snprintf(wanted + strlen(wanted), sizeof wanted - strlen(wanted), "\n");
    assert_string_equal(text_of(made.report), wanted);
    destroy(&made);
}

/* Three rows of two: 5, 22 and 39 mm from the tip at 50 mm are 45, 28 and 11 mm deep: in none, in the second box and in
 * the first. The next shank, which has no answer, keeps its channels; the one after it begins at 12. */
static void channels_go_on_from_shank_to_shank(void **state)
{
    (void)state;
    const conus_report_options options = {.format = "open-ephys",
                                          .contacts = {.count = 6, .columns = 2, .pitch = 17, .tip = 5}};
    struct made made = make(&options, 50);
    char wanted[256];
    assert_ok(conus_report_add_error(made.report, "b", 3, "is no pose"));
    assert_ok(conus_report_add_table(made.report, "c", made.segments));
    const char *first = made.atlas->objects[0].name;
    const char *second = made.atlas->objects[1].name;
    snprintf(wanted, sizeof wanted, "2-3,%s,141414;4-5,%s,0A0A0A;14-15,%s,141414;16-17,%s,0A0A0A\n", second, first,
             second, first);
    assert_string_equal(text_of(made.report), wanted);
    destroy(&made);
}

static void check_refused(const conus_report_options *options, double far, const char *words)
{
    struct made made = make(options, far);
    const char *text = "untouched";
    size_t size = 0;
    assert_fails(conus_report_text(&text, &size, made.report), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), words));
    assert_string_equal(text, "untouched");
    destroy(&made);
}

static void shanks_need_a_tip_and_channels(void **state)
{
    (void)state;
    conus_report_options options = {.format = "spikeglx"};
    check_refused(&options, 0, "range: a shank has its tip at the far end");
    options.format = "open-ephys";
    check_refused(&options, 50, "contacts: Open Ephys counts those of a shank, and there are none");
    options.contacts = (conus_contacts){.count = 7, .columns = 2, .pitch = 15, .tip = 5.5};
    check_refused(&options, 50, "contacts: the last is 50.5 mm from the tip, but the range is only 50 mm long");
    options.contacts.tip = 5; /* the last is at the base, those at 30 and 15 mm are in the first box */
    struct made made = make(&options, 50);
    char wanted[64];
    snprintf(wanted, sizeof wanted, "2-5,%s,0A0A0A\n", made.atlas->objects[0].name);
    assert_string_equal(text_of(made.report), wanted);
    destroy(&made);
}

static void what_does_not_go_together_is_refused(void **state)
{
    (void)state;
    static const conus_report_options wrong[] = {
        {.rows = "segments", .format = "spikeglx"},
        {.rows = "segments", .order = CONUS_ORDER_DEPTH},
        {.rows = "summaries", .format = "tsv", .order = CONUS_ORDER_DEPTH},
        {.format = "afni", .order = CONUS_ORDER_DEPTH},
        {.format = "tsv", .contacts = {1, 1, 1, 1}},
        {.format = "open-ephys", .contacts = {65537, 1, 1, 1}},
        {.format = "open-ephys", .contacts = {1, 0, 1, 1}},
        {.format = "open-ephys", .contacts = {1, 1, 0, 1}},
        {.format = "open-ephys", .contacts = {1, 1, NAN, 1}},
        {.format = "open-ephys", .contacts = {1, 1, 1, -1}},
        {.format = "open-ephys", .contacts = {1, 1, 1, INFINITY}},
    };
    struct made made = make(&(conus_report_options){.rows = "segments"}, 50);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        conus_report *report = NULL;
        assert_fails(conus_report_create(&report, made.selector, &wrong[i]), CONUS_ERROR_ARGUMENT);
        assert_null(report);
    }
    conus_report *answers = NULL;
    assert_ok(conus_report_create(&answers, made.selector, NULL));
    assert_fails(conus_report_add_table(answers, "a", made.segments), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(answers);
    assert_ok(conus_report_create(
        &answers, made.selector,
        &(conus_report_options){.format = "spikeglx", .space = CONUS_SPACE_LPS})); /* of RAS are the rows */
    assert_fails(conus_report_add_table(answers, "a", made.segments), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(answers);
    destroy(&made);
}

/* The table for people, with positions in LPS and an axis that meets no object. */
static void people_get_a_table(void **state)
{
    (void)state;
    struct made made = make(&(conus_report_options){.rows = "segments", .space = CONUS_SPACE_LPS}, 0);
    conus_table *none = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (const double[]){0, 0, 0}, (const double[]){-1, 0, 0}, NULL));
    assert_ok(conus_segments(&none, made.selector, &pose));
    assert_ok(conus_report_add_table(made.report, "b", none));
    assert_ok(conus_report_add_error(made.report, "c", 4, "is no pose"));
    static const char *const lines[] = {
        "query a: axis from (0.00, -0.10, 0.20) along (-1.0000, 0.0000, 0.0000), LPS mm\n",
        "order  name                label    enters    leaves    length         enters at x, y, z\n",
        "    1  (in no area)                   0.00     10.00     10.00      0.00   -0.10    0.20\n",
        "query b: axis from (0.00, 0.00, 0.00) along (1.0000, 0.0000, 0.0000), LPS mm\n",
        "    1  (in no area)                   0.00         -         -      0.00    0.00    0.00\n",
        "query c: no answer: line 4: is no pose\n",
    };
    const char *text = text_of(made.report);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        assert_non_null(strstr(text, lines[i]));
    }
    conus_table_destroy(none);
    destroy(&made);
}

TEST_GROUP(report_segments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_innermost_of_nested_areas_counts),
        cmocka_unit_test(channels_go_on_from_shank_to_shank),
        cmocka_unit_test(shanks_need_a_tip_and_channels),
        cmocka_unit_test(what_does_not_go_together_is_refused),
        cmocka_unit_test(people_get_a_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
