/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports on sweeps: the kinds of rows that they take, and failing allocations in every format. */
#include "conus/report.h"
#include "report_scene.h"
#include "test.h"

#include <string.h>

static conus_status add(conus_report *report, const struct report_scene *scene, const char *rows, const char *id)
{
    return strcmp(rows, "admissions") == 0 ? conus_report_add_table(report, id, scene->sweep)
           : strcmp(rows, "chances") == 0  ? conus_report_add_table(report, id, scene->jitter)
                                           : conus_report_add(report, id, scene->cone);
}

static void only_what_it_is_for_is_taken(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    FOR_WORDS(rows, "answers", "shares", "admissions", "chances")
    {
        conus_report *report = NULL;
        assert_ok(conus_report_create(&report, scene.selector, &(conus_report_options){.rows = rows}));
        FOR_WORDS(other, "shares", "admissions", "chances")
        {
            bool fits = strcmp(other, rows) == 0 || (strcmp(other, "shares") == 0 && strcmp(rows, "answers") == 0);
            assert_int_equal(add(report, &scene, other, "a"), fits ? CONUS_OK : CONUS_ERROR_ARGUMENT);
        }
        conus_report_destroy(report);
    }
    report_scene_destroy(&scene);
}

/* Two poses, an error and one of the poses again; then every output. */
static conus_status report_all(void *data)
{
    const struct report_scene *scene = data;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_report_create(&report, scene->selector, &scene->options);
    status = status ? status : add(report, scene, scene->options.rows, "one");
    status = status ? status : add(report, scene, scene->options.rows, "two");
    status = status ? status : conus_report_add_error(report, "three", 0, "is no pose");
    status = status ? status : add(report, scene, scene->options.rows, "two");
    status = status ? status : conus_report_text(&text, &size, report);
    if (!status) {
        assert_int_equal(strlen(text), size);
        assert_non_null(strstr(text, "is no pose"));
        assert_non_null(strstr(text, "tract"));
    }
    status = status ? status : conus_report_sidecar(&text, &size, report);
    conus_report_destroy(report);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    FOR_WORDS(rows, "shares", "admissions", "chances")
    {
        FOR_WORDS(format, "table", "tsv", "csv", "json", "ndjson")
        {
            scene.options = (conus_report_options){.rows = rows, .format = format};
            test_every_allocation(report_all, &scene);
        }
    }
    report_scene_destroy(&scene);
}

static size_t count(const char *text, const char *word)
{
    size_t found = 0;
    for (; (text = strstr(text, word)); text++) {
        found++;
    }
    return found;
}

/* Twelve angles of one pose make two tables, each with its header and each object once. */
static void shares_are_a_table_by_angle(void **state)
{
    (void)state;
    struct report_scene scene = report_scene_create();
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_create(&report, scene.selector, &(conus_report_options){.rows = "shares"}));
    for (int i = 0; i < 12; i++) {
        assert_ok(conus_report_add(report, "same", scene.cone));
    }
    assert_ok(conus_report_text(&text, &size, report));
    assert_int_equal(count(text, "share of cone"), 2);
    assert_int_equal(count(text, "(nothing hit)"), 2);
    assert_int_equal(count(text, "57.3"), 12);
    conus_report_destroy(report);
    report_scene_destroy(&scene);
}

TEST_GROUP(report_sweep)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_what_it_is_for_is_taken),
        cmocka_unit_test(every_failing_allocation_is_survived),
        cmocka_unit_test(shares_are_a_table_by_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
