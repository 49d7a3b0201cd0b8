/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports on the clearance of needles from boxes, whose distances follow by arithmetic. */
#include "atlas/atlas.h"
#include "conus/report.h"
#include "mesh_scene.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void add_box(conus_atlas *atlas, const double low[3], const double high[3])
{
    struct mesh box = mesh_scene_box(low, high);
    mesh_scene_add(atlas, &box);
}

struct made {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_table *clearances;
};

/* A needle of 2 mm along x from 0 to 20 mm. The boxes, from the farthest to the nearest: one 30 mm below; one 3 mm
 * behind the tip and 4 mm above it, so 5 mm away; one beside it from x = 4 on, 1.5 mm away; and one that it enters
 * at 10. */
static struct made make(double within, conus_space space)
{
    struct made made = {.atlas = mesh_scene_atlas()};
    conus_pose pose;
    add_box(made.atlas, (const double[]){0, -1, -40}, (const double[]){20, 1, -30});
    add_box(made.atlas, (const double[]){23, -1, 4}, (const double[]){25, 1, 5});
    add_box(made.atlas, (const double[]){4, 1.5, -1}, (const double[]){6, 3, 1});
    add_box(made.atlas, (const double[]){10, -1, -1}, (const double[]){12, 1, 1});
    assert_ok(conus_pose_along(&pose, (const double[]){0, 0, 0}, (const double[]){1, 0, 0}, NULL));
    conus_frame frame;
    assert_ok(conus_frame_find(&frame, NULL, space, NULL));
    assert_ok(conus_selector_create(&made.selector, made.atlas,
                                    &(conus_selector_options){.range = {0, 20}, .radius = 2, .frame = &frame}));
    assert_ok(conus_clearance(&made.clearances, made.selector, &pose, within));
    return made;
}

static void destroy(struct made *made)
{
    conus_table_destroy(made->clearances);
    conus_selector_destroy(made->selector);
    conus_atlas_destroy(made->atlas);
}

/* The text of a report on the needle as query a; the caller ends the report. */
static const char *text_of(conus_report **out, const struct made *made, const conus_report_options *options)
{
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_create(out, made->selector, options));
    assert_ok(conus_report_add_table(*out, "a", made->clearances));
    assert_ok(conus_report_text(&text, &size, *out));
    assert_int_equal(strlen(text), size);
    return text;
}

static void rows_are_ordered_by_clearance(void **state)
{
    (void)state;
    struct made made = make(10, CONUS_SPACE_LPS);
    conus_report *report = NULL;
    const conus_object *objects = made.atlas->objects;
    char wanted[1024];
    snprintf(wanted, sizeof wanted,
             "query\tkind\tindex\tname\tdistance_mm\tclearance_mm\tdepth_mm\tx\ty\tz\tnear_x\tnear_y\tnear_z\n"
             "a\tarea\t%u\t%s\t0\t-2\t10\t-10\t0\t0\t-10\t0\t0\n"
             "a\tarea\t%u\t%s\t1.5\t-0.5\t4\t-4\t0\t0\t-4\t-1.5\t0\n"
             "a\tarea\t%u\t%s\t5\t3\t20\t-20\t0\t0\t-23\t0\t4\n",
             objects[3].label, objects[3].name, objects[2].label, objects[2].name, objects[1].label, objects[1].name);
    const conus_report_options options = {
        .rows = "clearances", .format = "tsv", .space = CONUS_SPACE_LPS, .within = 10};
    assert_string_equal(text_of(&report, &made, &options), wanted);
    conus_report_destroy(report);
    destroy(&made);
}

static void people_are_told_what_touches(void **state)
{
    (void)state;
    struct made made = make(10, CONUS_SPACE_RAS);
    conus_report *report = NULL;
    const conus_report_options options = {.rows = "clearances", .within = 10};
    const char *text = text_of(&report, &made, &options);
    static const char *const parts[] = {
        "needle of radius 2 mm from (0.00, 0.00, 0.00) along (1.0000, 0.0000, 0.0000), 0 to 20 mm deep, RAS mm\n",
        "    pierces      0.00     10.00     10.00    0.00    0.00     10.00    0.00    0.00\n",
        "    touches      1.50      4.00      4.00    0.00    0.00      4.00    1.50    0.00\n",
        "       3.00      5.00     20.00     20.00    0.00    0.00     23.00    0.00    4.00\n",
        "up to 10 mm away, the nearest first; clearance is the distance of the axis less the radius\n",
    };
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const char *found = strstr(text, parts[i]);
        assert_non_null(found);
        text = found + 1;
    }
    conus_report_destroy(report);
    destroy(&made);
}

/* A device without a radius and a far end, and no object near to it. */
static void people_are_told_what_is_not_there(void **state)
{
    (void)state;
    struct made made = make(10, CONUS_SPACE_RAS);
    conus_selector *plain = NULL;
    conus_table *none = NULL;
    conus_report *report = NULL;
    conus_pose pose;
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_pose_along(&pose, (const double[]){0, 0, 100}, (const double[]){0, 0, 1}, NULL));
    assert_ok(conus_selector_create(&plain, made.atlas, NULL));
    assert_ok(conus_clearance(&none, plain, &pose, 2)); /* the boxes are 95 mm below, and farther */
    assert_ok(conus_report_create(&report, plain, &(conus_report_options){.rows = "clearances", .within = 2}));
    assert_ok(conus_report_add_table(report, "a", none));
    assert_ok(conus_report_add_error(report, "b", 3, "is no pose"));
    assert_ok(conus_report_text(&text, &size, report));
    static const char wanted[] =
        "query a: axis from (0.00, 0.00, 100.00) along (0.0000, 0.0000, 1.0000), without an end, RAS mm\n"
        "no area, pathway or bundle is that near\n\n"
        "query b: no answer: line 3: is no pose\n"
        "up to 2 mm away, the nearest first; without a radius the clearance is the distance of the axis\n";
    assert_memory_equal(text, wanted, sizeof wanted - 1);
    conus_report_destroy(report);
    conus_table_destroy(none);
    conus_selector_destroy(plain);
    destroy(&made);
}

static void all_that_there_is_may_be_asked_for(void **state)
{
    (void)state;
    struct made made = make(INFINITY, CONUS_SPACE_RAS);
    conus_report *report = NULL;
    const conus_report_options options = {.rows = "clearances", .format = "json", .within = INFINITY};
    const char *text = text_of(&report, &made, &options);
    assert_non_null(strstr(text, "\"within_mm\": null"));
    assert_non_null(strstr(text, "\"radius_mm\": 2"));
    assert_non_null(strstr(text, "\"clearance_mm\": 28")); /* 30 mm less 2 */
    conus_report_destroy(report);
    destroy(&made);
}

static void what_does_not_go_together_is_refused(void **state)
{
    (void)state;
    static const double wrong[] = {-1, NAN, -INFINITY};
    struct made made = make(10, CONUS_SPACE_RAS);
    conus_report *report = NULL;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const conus_report_options options = {.rows = "clearances", .within = wrong[i]};
        assert_fails(conus_report_create(&report, made.selector, &options), CONUS_ERROR_ARGUMENT);
        assert_null(report);
    }
    static const conus_report_options others[] = {
        {.rows = "segments", .within = 10}, {.rows = "clearances", .within = 9}, {.rows = "clearances", .within = 11}};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        assert_ok(conus_report_create(&report, made.selector, &others[i]));
        assert_fails(conus_report_add_table(report, "a", made.clearances), CONUS_ERROR_ARGUMENT);
        conus_report_destroy(report);
    }
    destroy(&made);
}

static conus_status report_on(void *data)
{
    const struct made *made = data;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status =
        conus_report_create(&report, made->selector, &(conus_report_options){.rows = "clearances", .within = 10});
    status = status ? status : conus_report_add_table(report, "a", made->clearances);
    status = status ? status : conus_report_text(&text, &size, report);
    status = status ? status : conus_report_sidecar(&text, &size, report);
    conus_report_destroy(report);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct made made = make(10, CONUS_SPACE_RAS);
    test_every_allocation(report_on, &made);
    destroy(&made);
}

TEST_GROUP(report_clearance)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_ordered_by_clearance),        cmocka_unit_test(people_are_told_what_touches),
        cmocka_unit_test(people_are_told_what_is_not_there),    cmocka_unit_test(all_that_there_is_may_be_asked_for),
        cmocka_unit_test(what_does_not_go_together_is_refused), cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
