/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports in other programs' formats: the kinds of rows that they take, and failing allocations. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "region_scene.h"
#include "report_scene.h"
#include "test.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char table[] = "name\tx\ty\tz\nA1\t0\t0\t0\nA2\tn/a\t0\t0\nA3\t1\t1\t1\n";

static conus_report_options options_of(const char *format)
{
    return (conus_report_options){.format = format, .electrodes = strcmp(format, "bids") == 0 ? table : NULL};
}

/* Two contacts with an answer, and one without between them. */
static conus_status report_all(void *data)
{
    const struct report_scene *scene = data;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_report_create(&report, scene->selector, &scene->options);
    status = status ? status : conus_report_add(report, "A1", scene->contacts[0]);
    status = status ? status : conus_report_add_error(report, "A2", 3, "is no pose");
    status = status ? status : conus_report_add(report, "A3", scene->contacts[1]);
    status = status ? status : conus_report_text(&text, &size, report);
    if (!status) {
        assert_int_equal(strlen(text), size);
        bool says_errors = strcmp(scene->options.format, "afni") == 0 || strcmp(scene->options.format, "bids") == 0;
        assert_int_equal(strstr(text, "line 3: is no pose") != NULL, says_errors);
    }
    status = status ? status : conus_report_sidecar(&text, &size, report);
    conus_report_destroy(report);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    FOR_WORDS(format, "afni", "bids", "spikeglx", "open-ephys")
    {
        scene.options = options_of(format);
        test_every_allocation(report_all, &scene);
    }
    report_scene_destroy(&scene);
}

static void only_answers_are_written_in_them(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    FOR_WORDS(format, "afni", "bids", "spikeglx", "open-ephys")
    {
        conus_report_options options = options_of(format);
        options.rows = "summaries";
        assert_fails(conus_report_create(&report, scene.selector, &options), CONUS_ERROR_ARGUMENT);
        options = options_of(format);
        options.electrodes = strcmp(format, "bids") == 0 ? NULL : table;
        assert_fails(conus_report_create(&report, scene.selector, &options), CONUS_ERROR_ARGUMENT);
        options = options_of(format);
        assert_ok(conus_report_create(&report, scene.selector, &options));
        if (strcmp(format, "spikeglx") == 0 || strcmp(format, "open-ephys") == 0) {
            assert_fails(conus_report_take(&text, &size, report), CONUS_ERROR_ARGUMENT);
        }
        conus_report_destroy(report);
    }
    report_scene_destroy(&scene);
}

static void a_table_has_a_row_for_each_answer(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    const conus_report_options options = options_of("bids");
    for (size_t answers = 0; answers < 6; answers++) {
        conus_report *report = NULL;
        const char *text = NULL;
        size_t size = 0;
        assert_ok(conus_report_create(&report, scene.selector, &options));
        for (size_t i = 0; i < answers; i++) {
            assert_ok(conus_report_add(report, "same", scene.contacts[0]));
        }
        conus_status status = conus_report_text(&text, &size, report);
        assert_int_equal(status, answers == 3 ? CONUS_OK : CONUS_ERROR_DATA);
        conus_report_destroy(report);
    }
    report_scene_destroy(&scene);
}

/* The parts, taken answer by answer, make the whole. */
static void parts_join_without_a_seam(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    FOR_WORDS(format, "afni", "bids")
    {
        const conus_report_options options = options_of(format);
        conus_report *whole = NULL;
        conus_report *parts = NULL;
        struct buffer joined = {0};
        const char *text = NULL;
        size_t size = 0;
        assert_ok(conus_report_create(&whole, scene.selector, &options));
        assert_ok(conus_report_create(&parts, scene.selector, &options));
        for (int i = 0; i < 3; i++) {
            assert_ok(conus_report_add(whole, "same", scene.contacts[0]));
            assert_ok(conus_report_add(parts, "same", scene.contacts[0]));
            assert_ok(conus_report_take(&text, &size, parts));
            buffer_append(&joined, text, size);
        }
        assert_ok(conus_report_text(&text, &size, whole));
        assert_int_equal(size, joined.size);
        assert_memory_equal(text, joined.data, size);
        assert_ok(conus_report_add(parts, "one too many", scene.contacts[0]));
        assert_int_equal(conus_report_take(&text, &size, parts),
                         strcmp(format, "bids") == 0 ? CONUS_ERROR_DATA : CONUS_OK);
        buffer_finish(&joined);
        conus_report_destroy(whole);
        conus_report_destroy(parts);
    }
    report_scene_destroy(&scene);
}

/* The writer does not use jansson: parsed and dumped by jansson its rows are the same bytes, also with exponents, zeros
 * with a sign, and names that need escapes. */
static void json_is_what_jansson_writes(void **state)
{
    (void)state;
    static const char *const ids[] = {"plain", "a \"b\"", "a \\ c", "two\nlines\t\x01\x7f",
                                      "Gr\303\266\303\237e/\342\202\254"};
    static const double points[][3] = {
        {1e-7, -0.0, 3e-5}, {5, 6, 7}, {1e-4, 0.1, -2e-9}, {-1e-5, 1.5, 0}, {0.123456789012, 3, 1e-12}};
    const conus_report_options options = {.format = "json"};
    conus_atlas *atlas = region_scene_slabs();
    conus_selector *selector = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_report_create(&report, selector, &options));
    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++) {
        conus_selection *ball = NULL;
        assert_ok(conus_select_ball(&ball, selector, points[i], 1e-3));
        assert_ok(conus_report_add(report, ids[i], ball));
        conus_selection_destroy(ball);
    }
    assert_ok(conus_report_text(&text, &size, report));
    const char *rows = strstr(text, "\n \"Rows\": [\n");
    assert_non_null(rows);
    assert_non_null(strstr(rows, "e-"));
    assert_non_null(strstr(rows, "a \\\"b\\\""));
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(root);
    char *dumped = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    assert_non_null(dumped);
    assert_int_equal(strlen(dumped) + 1, size); /* and the end of the line */
    assert_memory_equal(dumped, text, size - 1);
    free(dumped);
    json_decref(root);
    conus_report_destroy(report);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Two answers of one name and an error, told apart by number, time and two columns of their own. */
static conus_status report_marked(void *data)
{
    const struct report_scene *scene = data;
    static const char *const names[] = {"group", "a,b"};
    static const char *const texts[][2] = {{"patient", "x\"y"}, {"", NULL}, {"tab\there", "z"}};
    conus_row_marks marks = {.has_number = true, .has_time = true, .names = names, .count = 2};
    conus_report_options options = scene->options;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    options.marks = &marks;
    conus_status status = conus_report_create(&report, scene->selector, &options);
    for (int i = 0; i < 3 && !status; i++) {
        marks.number = (uint64_t)i + 7;
        marks.time_s = i == 1 ? NAN : 0.5 * i;
        marks.texts = texts[i];
        status = i == 1 ? conus_report_add_error(report, "A", 3, "is no pose")
                        : conus_report_add(report, "A", scene->contacts[i / 2]);
    }
    marks.texts = NULL; /* copied */
    status = status ? status : conus_report_text(&text, &size, report);
    for (int i = 0; i < 3 && !status; i++) {
        static const struct {
            const char *format, *parts[3];
        } wanted[] = {{"table",
                       {"query A (row 7, 0 s, group patient, a,b x\"y): ", "query A (row 8): no answer: line 3",
                        "query A (row 9, 1 s, group tab here, a,b z): "}},
                      {"tsv", {"\tgroup\ta,b\nA\t7\t0\t", "\nA\t8\tn/a\terror\t", "\ttab here\tz\n"}},
                      {"csv", {",group,\"a,b\"\r\nA,7,0,", ",patient,\"x\"\"y\"\r\n", "A,8,n/a,error,"}},
                      {"json", {"\"a,b\": \"x\\\"y\"", "\"row\": 8", "\"time_s\": null"}},
                      {"ndjson",
                       {"\"group\":\"patient\",\"a,b\":\"x\\\"y\"}\n",
                        "{\"query\":\"A\",\"row\":8,\"time_s\":null,\"kind\":\"error\"", "\"group\":\"tab here\""}}};
        size_t at = 0;
        while (strcmp(wanted[at].format, options.format) != 0) {
            at++;
        }
        if (!strstr(text, wanted[at].parts[i])) {
            fail_msg("format %s: no %s in\n%s", options.format, wanted[at].parts[i], text);
        }
    }
    status = status ? status : conus_report_sidecar(&text, &size, report);
    if (!status) {
        json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
        assert_non_null(json_object_get(json_object_get(root, "Kept"), "a,b"));
        assert_non_null(json_object_get(root, "row"));
        assert_int_equal(
            json_integer_value(json_object_get(json_array_get(json_object_get(root, "Queries"), 1), "row")), 8);
        json_decref(root);
    }
    conus_report_destroy(report);
    return status;
}

static void rows_of_one_name_are_told_apart(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    FOR_WORDS(format, "table", "tsv", "csv", "json", "ndjson")
    {
        scene.options = options_of(format);
        test_every_allocation(report_marked, &scene);
    }
    report_scene_destroy(&scene);
}

static void what_a_row_has_is_not_kept_again(void **state)
{
    (void)state;
    static const char *const names[][2] = {{"share", "a"}, {"row", "a"}, {"a", "a"}};
    struct report_scene scene = report_scene_create();
    for (size_t i = 0; i < 3; i++) {
        const conus_row_marks marks = {.has_number = true, .names = names[i], .count = 2};
        conus_report *report = NULL;
        scene.options.marks = &marks;
        assert_fails(conus_report_create(&report, scene.selector, &scene.options), CONUS_ERROR_ARGUMENT);
        assert_non_null(strstr(conus_message(), "cannot be kept"));
    }
    report_scene_destroy(&scene);
}

/* 212 of them would not come back from radians. A cone has them all, errors of a pose those up to 90. */
static void degrees_come_out_as_they_were_given(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    const conus_pose pose = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 50, 1}};
    conus_selector *selector = NULL;
    size_t lost = 0;
    assert_ok(conus_selector_create(&selector, scene.atlas, &(conus_selector_options){.resolution = 1}));
    scene.options.format = "json";
    for (int tenths = 1; tenths < 1800; tenths++) {
        const double degrees = tenths / 10.0;
        conus_selection *selection = NULL;
        conus_report *report = NULL;
        const char *text = NULL;
        size_t size = 0;
        assert_ok(conus_select(&selection, selector, &pose, degrees));
        assert_ok(conus_report_create(&report, selector, &scene.options));
        assert_ok(conus_report_add(report, "1", selection));
        assert_ok(conus_report_text(&text, &size, report));
        const char *said = strstr(text, "\"angle_deg\": ");
        assert_non_null(said);
        assert_true(strtod(said + 13, NULL) == degrees);
        lost += degrees_from_radians(radians_from_degrees(degrees)) != degrees;
        conus_report_destroy(report);
        conus_selection_destroy(selection);
        if (tenths <= 900) {
            conus_table *jitter = NULL;
            assert_ok(
                conus_jitter(&jitter, selector, &pose, 20, &(conus_jitter_options){.tilt = degrees, .samples = 16}));
            assert_true(conus_table_numbers(jitter, "error_deg")[0] == degrees);
            conus_table_destroy(jitter);
        }
    }
    assert_int_equal(lost, 212);
    conus_selector_destroy(selector);
    report_scene_destroy(&scene);
}

TEST_GROUP(report_formats)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_failing_allocation_is_survived), cmocka_unit_test(only_answers_are_written_in_them),
        cmocka_unit_test(a_table_has_a_row_for_each_answer),    cmocka_unit_test(parts_join_without_a_seam),
        cmocka_unit_test(json_is_what_jansson_writes),          cmocka_unit_test(rows_of_one_name_are_told_apart),
        cmocka_unit_test(what_a_row_has_is_not_kept_again),     cmocka_unit_test(degrees_come_out_as_they_were_given),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
