/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports on plans: all kinds of rows and formats, for needles beside a box, whose numbers follow by arithmetic. */
#include "base/files/file.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "test.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

struct made {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_plan *plan;
};

static const conus_constraint CONSTRAINTS[] = {
    {.kind = CONUS_CONSTRAINT_REACH, .names = "1", .limit = 4},
    {.kind = CONUS_CONSTRAINT_AVOID, .names = "2", .limit = 3},
    {.kind = CONUS_CONSTRAINT_LEAN, .direction = {0, 0, 2}, .limit = 114.591559},
};

/* Axes along x from 0 through the box from 10 to 40, to the depths 16, 13 and 27. A second box begins at 30; around it
 * is that of the first. */
static struct made make(void)
{
    static const char needles[] = "query_id\tx\ty\tz\tdx\tdy\tdz\tfar\n"
                                  "a\t0\t0\t0\t1\t0\t0\t16\n"
                                  "b\t0\t0\t0\t1\t0\t0\t13\n"
                                  "c\t0\t0\t0\t1\t0\t0\t27\n";
    struct made made = {.atlas = mesh_scene_atlas()};
    struct mesh near = mesh_scene_box((const double[]){10, -50, -50}, (const double[]){40, 50, 50});
    struct mesh far = mesh_scene_box((const double[]){30, -20, -20}, (const double[]){40, 20, 20});
    const char *path = test_scratch("needles.tsv");
    conus_pose_stream *poses = NULL;
    mesh_scene_add(made.atlas, &near);
    mesh_scene_add(made.atlas, &far);
    assert_ok(file_write(path, needles, strlen(needles)));
    assert_ok(conus_selector_create(&made.selector, made.atlas, &(conus_selector_options){.radius = 0.5}));
    const conus_jitter_options none = {.samples = 16}; /* without errors all probabilities are 0 or 1 */
    assert_ok(conus_plan_create(&made.plan, made.selector, CONSTRAINTS, 3,
                                &(conus_plan_options){.infeasible = true, .jitter = &none}));
    assert_ok(conus_pose_stream_open(&poses, path, NULL));
    assert_ok(conus_plan_run(made.plan, poses, UINT64_MAX));
    conus_pose_stream_destroy(poses);
    return made;
}

static void destroy(struct made *made)
{
    conus_plan_destroy(made->plan);
    conus_selector_destroy(made->selector);
    conus_atlas_destroy(made->atlas);
}

/* Writes all text of a report, which is the caller's. */
static conus_status write_report(conus_report **out, const char **text, const struct made *made, const char *rows,
                                 const char *format)
{
    size_t size = 0;
    conus_status status =
        conus_report_create(out, made->selector, &(conus_report_options){.rows = rows, .format = format});
    status = status                           ? status
             : strcmp(rows, "profile") == 0   ? conus_report_add_profile(*out, made->plan, 10)
             : strcmp(rows, "tolerance") == 0 ? conus_report_add_tolerance(*out, made->plan, NULL)
                                              : conus_report_add_plan(*out, made->plan);
    return status ? status : conus_report_text(text, &size, *out);
}

/* Asserts that the report has these lines from line `first` on, with spaces for tabs, and without the leeways of
 * constraints, which are lower bounds. */
static void has_lines(const struct made *made, const char *rows, size_t first, const char *wanted)
{
    conus_report *report = NULL;
    const char *text = NULL;
    char lines[4096];
    assert_ok(write_report(&report, &text, made, rows, "tsv"));
    for (; first > 0; first--) {
        text = strchr(text, '\n') + 1;
    }
    size_t used = 0;
    size_t cell = 0;
    for (; *text && used + 1 < sizeof lines; text++) {
        cell = *text == '\n' ? 0 : cell + (*text == '\t');
        if (*text == '\n' || strcmp(rows, "constraints") != 0 || cell < 9) {
            lines[used++] = *text == '\t' ? ' ' : *text;
        }
    }
    lines[used] = '\0';
    assert_string_equal(lines, wanted);
    conus_report_destroy(report);
}

/* a is 6 mm in the first box and 14 mm from the second, c 17 and 3 mm, b 3 and 17 mm; all lean by 90 degrees, which is
 * less than 114.6. The slack of c is 3 mm less the margin and the radius, -0.5. */
static void rows_follow_from_the_boxes(void **state)
{
    (void)state;
    struct made made = make();
    has_lines(&made, "constraints", 1,
              "a 1 reach 1 area 6 4 2 1\na 2 avoid 1 area 14 3 10.5 1\n"
              "a 3 lean 1 n/a 90 114.591559 24.591559 1\n"
              "b 1 reach 1 area 3 4 -1 0\nb 2 avoid 1 area 17 3 13.5 1\n"
              "b 3 lean 1 n/a 90 114.591559 24.591559 1\n"
              "c 1 reach 1 area 17 4 13 1\nc 2 avoid 1 area 3 3 -0.5 0\n"
              "c 3 lean 1 n/a 90 114.591559 24.591559 1\n");
    has_lines(&made, "profile", 1,
              "a 1 0 0 0 0 avoid 1 area 30 29.5\na 2 10 10 0 0 avoid 1 area 20 19.5\n"
              "a 3 16 16 0 0 avoid 1 area 14 13.5\n"
              "b 1 0 0 0 0 avoid 1 area 30 29.5\nb 2 10 10 0 0 avoid 1 area 20 19.5\n"
              "b 3 13 13 0 0 avoid 1 area 17 16.5\n"
              "c 1 0 0 0 0 avoid 1 area 30 29.5\nc 2 10 10 0 0 avoid 1 area 20 19.5\n"
              "c 3 20 20 0 0 avoid 1 area 10 9.5\nc 4 27 27 0 0 avoid 1 area 3 2.5\n");
    has_lines(&made, "plan", 2,
              "b n/a 0 area n/a n/a 0 0 0 1 0 0 13 0 0 13 n/a 0 area 13.5 16.5 area 13 n/a 0 3 0 17 13 1 90 1\n"
              "c n/a 0 area n/a n/a 0 0 0 1 0 0 27 0 0 27 n/a 0 area -0.5 2.5 area 27 n/a 0 17 1 3 27 0 90 1\n");
    destroy(&made);
}

static void constraints_are_worded(void **state)
{
    (void)state;
    struct made made = make();
    conus_report *report = NULL;
    const char *text = NULL;
    assert_ok(write_report(&report, &text, &made, "plan", "table"));
    conus_table *constraints = NULL;
    assert_ok(conus_plan_list(&constraints, made.plan, "constraints"));
    const char *const *asked = conus_table_texts(constraints, "asked");
    assert_int_equal(conus_table_rows(constraints), 3);
    assert_string_equal(asked[0], "at least 4 mm of the axis in area");
    assert_string_equal(asked[1], "more than 3 mm of clearance from area");
    assert_string_equal(asked[2], "at most 114.591559 degrees between axis and RAS direction (0, 0, 1)");
    assert_string_equal(conus_table_texts(constraints, "kind")[2], "lean");
    assert_null(conus_table_texts(constraints, "name")[2]);
    assert_string_equal(conus_table_texts(constraints, "name")[0], "area");
    for (size_t i = 0; i < 3; i++) {
        const conus_planned *miss = conus_plan_miss(made.plan, i);
        const char *id = conus_table_texts(constraints, "miss")[i];
        assert_int_equal(conus_table_counts(constraints, "left")[i], conus_plan_left(made.plan, i + 1));
        assert_true(miss ? id && strcmp(id, miss->id) == 0 : !id);
    }
    conus_table_destroy(constraints);
    assert_fails(conus_plan_list(&constraints, made.plan, "poses"), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_plan_list(&constraints, made.plan, NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(text, "breaks"));
    assert_fails(conus_report_add_plan(report, made.plan), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    assert_ok(conus_report_create(&report, made.selector, NULL));
    assert_fails(conus_report_add_plan(report, made.plan), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_report_add_profile(report, made.plan, 1), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    const double steps[] = {0, -1, 1e-9, (double)NAN};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        assert_ok(conus_report_create(&report, made.selector, &(conus_report_options){.rows = "profile"}));
        assert_fails(conus_report_add_profile(report, made.plan, steps[i]), CONUS_ERROR_ARGUMENT);
        conus_report_destroy(report);
    }
    assert_true(conus_column_is_number("row"));
    assert_true(conus_column_is_number("reach1_mm"));
    assert_true(conus_column_is_number("avoid12_at_mm"));
    assert_true(conus_column_is_number("p_reach1"));
    assert_false(conus_column_is_number("p_reachable"));
    assert_false(conus_column_is_number("reachable"));
    assert_false(conus_column_is_number("clearance_of"));
    destroy(&made);
}

static void every_sidecar_tells_of_the_plan(void **state)
{
    (void)state;
    struct made made = make();
    static const char *const rows[] = {"plan", "constraints", "profile", "tolerance"};
    for (size_t i = 0; i < 4; i++) {
        conus_report *report = NULL;
        const char *text = NULL;
        size_t size = 0;
        assert_ok(write_report(&report, &text, &made, rows[i], "tsv"));
        assert_ok(conus_report_sidecar(&text, &size, report));
        json_t *root = json_loadb(text, size, 0, NULL);
        const json_t *plan = json_object_get(root, "Plan");
        const json_t *funnel = json_object_get(plan, "funnel");
        assert_int_equal(json_integer_value(json_object_get(plan, "candidates")), 3);
        assert_int_equal(json_integer_value(json_array_get(funnel, 0)), 2);
        assert_int_equal(json_integer_value(json_array_get(funnel, 2)), 1);
        assert_int_equal(json_array_size(json_object_get(plan, "constraints")), 3);
        assert_int_equal(json_integer_value(json_object_get(json_object_get(plan, "jitter"), "samples")), 16);
        json_decref(root);
        conus_report_destroy(report);
    }
    destroy(&made);
}

static conus_status report_all(void *user)
{
    const struct made *made = user;
    conus_status status = CONUS_OK;
    FOR_WORDS(rows, "plan", "constraints", "profile")
    {
        FOR_WORDS(format, "table", "tsv", "csv", "json", "ndjson")
        {
            conus_report *report = NULL;
            const char *text = NULL;
            size_t size = 0;
            status = status ? status : write_report(&report, &text, made, rows, format);
            status = status ? status : conus_report_sidecar(&text, &size, report);
            conus_report_destroy(report);
        }
    }
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct made made = make();
    test_every_allocation(report_all, &made);
    destroy(&made);
}

TEST_GROUP(report_plan)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_follow_from_the_boxes),
        cmocka_unit_test(constraints_are_worded),
        cmocka_unit_test(every_sidecar_tells_of_the_plan),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
