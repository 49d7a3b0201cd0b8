/* SPDX-License-Identifier: BSD-3-Clause */
/* Joined reports on several atlases: the rows of each report, put together with a column. */
#include "base/memory.h"
#include "conus/own.h"
#include "report_scene.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

enum { ATLASES = 3, QUERIES = 3 };

static const char *const names[ATLASES] = {"a, \"b\"", "aal", "aal-2"};
static const char *const in_csv[ATLASES] = {"\"a, \"\"b\"\"\"", "aal", "aal-2"}; /* RFC 4180 */
static const char *const in_json[ATLASES] = {"\"a, \\\"b\\\"\"", "\"aal\"", "\"aal-2\""};

struct scenes {
    struct report_scene at[ATLASES];
};

/* Three different atlases with the same queries. */
static struct scenes create_scenes(void)
{
    struct scenes scenes;
    for (size_t i = 0; i < ATLASES; i++) {
        scenes.at[i] = report_scene_create_from(8 + i);
    }
    return scenes;
}

static void destroy_scenes(struct scenes *scenes)
{
    for (size_t i = 0; i < ATLASES; i++) {
        report_scene_destroy(&scenes->at[i]);
    }
}

/* Adds query `index`; the second one has no answer. */
static conus_status add_query(conus_report *report, const struct report_scene *scene, const char *rows, int index)
{
    char id[16];
    snprintf(id, sizeof id, "q%d", index);
    return index == 1                        ? conus_report_add_error(report, id, 7, "is no pose")
           : strcmp(rows, "admissions") == 0 ? conus_report_add_table(report, id, scene->sweep)
           : strcmp(rows, "chances") == 0    ? conus_report_add_table(report, id, scene->jitter)
                                             : conus_report_add(report, id, scene->cone);
}

/* Appends `rows`, lines of one of the formats, with a cell behind the first one of each. */
static void put_with_cell(struct buffer *out, const char *format, const char *rows, const char *cell)
{
    const char separator = strcmp(format, "tsv") == 0 ? '\t' : ',';
    while (*rows) {
        const char *end = strchr(rows, '\n') + 1;
        const char *behind = strchr(rows, separator);
        buffer_append(out, rows, (size_t)(behind - rows));
        buffer_format(out, strcmp(format, "ndjson") == 0 ? "%c\"atlas\":%s" : "%c%s", separator, cell);
        buffer_append(out, behind, (size_t)(end - behind));
        rows = end;
    }
}

static const char *cell_of(const char *format, size_t atlas)
{
    return strcmp(format, "csv") == 0 ? in_csv[atlas] : strcmp(format, "ndjson") == 0 ? in_json[atlas] : names[atlas];
}

/* The wanted text: the rows of reports on each atlas alone, query by query. */
static void put_wanted(struct buffer *out, const struct scenes *scenes, const conus_report_options *options)
{
    conus_report *reports[ATLASES];
    const char *text = NULL;
    size_t size = 0;
    for (size_t i = 0; i < ATLASES; i++) {
        assert_ok(conus_report_create(&reports[i], scenes->at[i].selector, options));
        assert_ok(conus_report_take(&text, &size, reports[i]));
        put_with_cell(out, options->format, i ? "" : text, "atlas"); /* the header row */
    }
    for (int query = 0; query < QUERIES; query++) {
        for (size_t i = 0; i < ATLASES; i++) {
            assert_ok(add_query(reports[i], &scenes->at[i], options->rows, query));
            assert_ok(conus_report_take(&text, &size, reports[i]));
            put_with_cell(out, options->format, text, cell_of(options->format, i));
        }
    }
    for (size_t i = 0; i < ATLASES; i++) {
        conus_report_destroy(reports[i]);
    }
    assert_ok(buffer_status(out));
}

/* Joins reports without queries. */
static conus_status join(conus_report *out[ATLASES], const struct scenes *scenes, const conus_report_options *options)
{
    conus_status status = CONUS_OK;
    conus_report_options own = *options;
    for (size_t i = 0; i < ATLASES && !status; i++) {
        own.atlas = names[i];
        status = conus_report_create(&out[i], scenes->at[i].selector, &own);
        status = status || !i ? status : conus_report_join(out[0], out[i]);
    }
    return status;
}

static void destroy_all(conus_report *reports[ATLASES])
{
    for (size_t i = 0; i < ATLASES; i++) {
        conus_report_destroy(reports[i]);
    }
}

static void check_rows(const struct scenes *scenes, const conus_report_options *options)
{
    struct buffer wanted = {0};
    struct buffer parts = {0};
    conus_report *whole[ATLASES];
    conus_report *taken[ATLASES];
    const char *text = NULL;
    size_t size = 0;
    put_wanted(&wanted, scenes, options);
    assert_ok(join(whole, scenes, options));
    assert_ok(join(taken, scenes, options));
    for (int query = 0; query < QUERIES; query++) {
        for (size_t i = ATLASES; i-- > 0;) { /* the order in which they are asked does not matter */
            assert_ok(add_query(whole[i], &scenes->at[i], options->rows, query));
            assert_ok(add_query(taken[i], &scenes->at[i], options->rows, query));
        }
        assert_ok(conus_report_take(&text, &size, taken[0]));
        buffer_append(&parts, text, size);
    }
    assert_ok(conus_report_text(&text, &size, whole[0]));
    assert_string_equal(text, wanted.data);
    assert_string_equal(parts.data, wanted.data);
    destroy_all(whole);
    destroy_all(taken);
    buffer_finish(&wanted);
    buffer_finish(&parts);
}

static void rows_are_those_of_each_atlas_with_its_name(void **state)
{
    static const char *const formats[] = {"tsv", "csv", "ndjson"};
    struct scenes scenes = create_scenes();
    (void)state;
    FOR_WORDS(rows, "answers", "shares", "admissions", "chances", "summaries")
    {
        for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
            check_rows(&scenes, &(conus_report_options){.rows = rows, .format = formats[i]});
        }
    }
    destroy_scenes(&scenes);
}

/* Two angles of one pose have one id: the rows of an atlas come before those of the next. */
static void shares_of_a_pose_stay_together(void **state)
{
    const conus_report_options options = {.rows = "shares", .format = "ndjson"};
    struct scenes scenes = create_scenes();
    struct buffer wanted = {0};
    conus_report *reports[ATLASES];
    const char *text = NULL;
    size_t size = 0;
    (void)state;
    assert_ok(join(reports, &scenes, &options));
    for (size_t i = 0; i < ATLASES; i++) {
        conus_report *alone = NULL;
        assert_ok(conus_report_create(&alone, scenes.at[i].selector, &options));
        for (int angle = 0; angle < 2; angle++) {
            assert_ok(conus_report_add(alone, "q", scenes.at[i].cone));
            assert_ok(conus_report_add(reports[i], "q", scenes.at[i].cone));
        }
        assert_ok(conus_report_text(&text, &size, alone));
        put_with_cell(&wanted, options.format, text, in_json[i]);
        conus_report_destroy(alone);
    }
    assert_ok(conus_report_text(&text, &size, reports[0]));
    assert_string_equal(text, wanted.data);
    buffer_finish(&wanted);
    destroy_all(reports);
    destroy_scenes(&scenes);
}

/* Appends the voxels of one pose from a report on one atlas, without the header row, with a cell for the atlas. */
static void put_voxels(struct buffer *out, const struct report_scene *scene, const char *name)
{
    const conus_report_options options = {.all_voxels = true};
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_create(&report, scene->selector, &options));
    assert_ok(conus_report_add(report, "q", scene->cone));
    assert_ok(conus_report_voxels(&text, &size, report));
    put_with_cell(out, "tsv", strchr(text, '\n') + 1, name);
    conus_report_destroy(report);
}

/* The same pose twice, with an error between: its voxels come twice, each time those of all atlases. */
static void voxels_have_the_name_of_their_atlas(void **state)
{
    struct scenes scenes = create_scenes();
    struct buffer once = {0};
    struct buffer wanted = {0};
    conus_report *reports[ATLASES];
    const char *text = NULL;
    size_t size = 0;
    (void)state;
    assert_ok(join(reports, &scenes, &(conus_report_options){.all_voxels = true}));
    for (size_t i = 0; i < ATLASES; i++) {
        put_voxels(&once, &scenes.at[i], names[i]);
        assert_ok(conus_report_add(reports[i], "q", scenes.at[i].cone));
        assert_ok(conus_report_add_error(reports[i], "q", 7, "is no pose"));
        assert_ok(conus_report_add(reports[i], "q", scenes.at[i].cone));
    }
    buffer_text(&wanted, "query\tatlas\tpathway\ti\tj\tk\tx\ty\tz\tvalue\tdistance_mm\tkind\tindex\n");
    buffer_text(&wanted, once.data);
    buffer_text(&wanted, once.data);
    assert_ok(conus_report_voxels(&text, &size, reports[0]));
    assert_string_equal(text, wanted.data);
    buffer_finish(&once);
    buffer_finish(&wanted);
    destroy_all(reports);
    destroy_scenes(&scenes);
}

/* Rows on a moved atlas have columns that rows on another one lack. */
static void a_moved_atlas_is_joined_with_moved_ones_only(void **state)
{
    const double identity[16] = {[0] = 1, [5] = 1, [10] = 1, [15] = 1};
    struct scenes scenes = create_scenes();
    conus_selector *selector = NULL;
    conus_report *plain = NULL;
    conus_report *moved = NULL;
    (void)state;
    assert_ok(conus_atlas_move(scenes.at[1].atlas, identity));
    assert_ok(conus_selector_create(&selector, scenes.at[1].atlas, NULL));
    assert_ok(conus_report_create(&moved, selector, &(conus_report_options){.atlas = "moved"}));
    conus_selector_destroy(selector);
    assert_ok(conus_selector_create(&selector, scenes.at[0].atlas, NULL));
    assert_ok(conus_report_create(&plain, selector, &(conus_report_options){.atlas = "plain"}));
    assert_fails(conus_report_join(plain, moved), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "moved"));
    conus_selector_destroy(selector);
    conus_report_destroy(plain);
    assert_ok(conus_atlas_move(scenes.at[0].atlas, identity));
    assert_ok(conus_selector_create(&selector, scenes.at[0].atlas, NULL));
    assert_ok(conus_report_create(&plain, selector, &(conus_report_options){.atlas = "plain"}));
    assert_ok(conus_report_join(plain, moved));
    conus_report_destroy(plain);
    conus_report_destroy(moved);
    conus_selector_destroy(selector);
    destroy_scenes(&scenes);
}

/* Refused, since their columns or queries would differ. */
static void what_does_not_belong_together_is_not_joined(void **state)
{
    static const conus_report_options other[] = {{.atlas = "first"},
                                                 {0},
                                                 {.atlas = "second", .format = "csv"},
                                                 {.atlas = "second", .rows = "chances"},
                                                 {.atlas = "second", .space = CONUS_SPACE_LPS}};
    struct scenes scenes = create_scenes();
    conus_report *reports[2];
    conus_report *third = NULL;
    conus_selector *fine = NULL;
    const char *text = NULL;
    size_t size = 0;
    (void)state;
    assert_ok(conus_report_create(&reports[0], scenes.at[0].selector, &(conus_report_options){.atlas = "first"}));
    assert_fails(conus_report_join(reports[0], reports[0]), CONUS_ERROR_ARGUMENT);
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++) {
        assert_ok(conus_report_create(&reports[1], scenes.at[1].selector, &other[i]));
        assert_fails(conus_report_join(reports[0], reports[1]), CONUS_ERROR_ARGUMENT);
        conus_report_destroy(reports[1]);
    }
    assert_ok(conus_selector_create(&fine, scenes.at[1].atlas, &(conus_selector_options){.resolution = 17}));
    assert_ok(conus_report_create(&reports[1], fine, &(conus_report_options){.atlas = "second"}));
    assert_fails(conus_report_join(reports[0], reports[1]), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(reports[1]);
    conus_selector_destroy(fine);
    assert_ok(conus_report_create(&reports[1], scenes.at[1].selector, &(conus_report_options){.atlas = "second"}));
    assert_ok(conus_report_join(reports[0], reports[1]));
    assert_fails(conus_report_join(reports[0], reports[1]), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_report_create(&third, scenes.at[2].selector, &(conus_report_options){.atlas = "second"}));
    assert_fails(conus_report_join(reports[0], third), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(third);
    assert_ok(conus_report_add(reports[0], "q", scenes.at[0].cone));
    assert_fails(conus_report_text(&text, &size, reports[0]), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_report_take(&text, &size, reports[0]), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_report_voxels(&text, &size, reports[0]), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(reports[0]);
    conus_report_destroy(reports[1]);
    destroy_scenes(&scenes);
}

/* Formats of other programs have no column for the atlas, and a name is needed. */
static void some_reports_have_no_such_column(void **state)
{
    struct report_scene scene = report_scene_create();
    conus_report *report = NULL;
    (void)state;
    FOR_WORDS(format, "afni", "bids", "spikeglx", "open-ephys")
    {
        const conus_report_options options = {.format = format, .atlas = "aal", .electrodes = "name\tx\ty\tz\n"};
        assert_fails(conus_report_create(&report, scene.selector, &options), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_report_create(&report, scene.selector, &(conus_report_options){.atlas = ""}),
                 CONUS_ERROR_ARGUMENT);
    report_scene_destroy(&scene);
}

struct attempt {
    const struct scenes *scenes;
    conus_report_options options;
};

static conus_status report_all(void *data)
{
    const struct attempt *attempt = data;
    conus_report *reports[ATLASES] = {NULL};
    const char *text = NULL;
    size_t size = 0;
    conus_status status = join(reports, attempt->scenes, &attempt->options);
    for (int query = 0; query < QUERIES; query++) {
        for (size_t i = 0; i < ATLASES && !status; i++) {
            status = add_query(reports[i], &attempt->scenes->at[i], attempt->options.rows, query);
        }
    }
    status = status ? status : conus_report_text(&text, &size, reports[0]);
    if (!status && strcmp(attempt->options.format, "table") == 0) {
        assert_non_null(strstr(text, "\natlas aal-2\n"));
    }
    status = status ? status : conus_report_sidecar(&text, &size, reports[0]);
    status = status ? status : conus_report_voxels(&text, &size, reports[0]);
    destroy_all(reports);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    struct scenes scenes = create_scenes();
    (void)state;
    FOR_WORDS(rows, "answers", "shares", "admissions", "chances")
    {
        struct attempt attempt = {&scenes, {.rows = rows, .format = "table"}};
        test_every_allocation(report_all, &attempt);
    }
    struct attempt attempt = {&scenes, {.rows = "answers", .format = "json"}};
    test_every_allocation(report_all, &attempt);
    destroy_scenes(&scenes);
}

TEST_GROUP(report_join)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(rows_are_those_of_each_atlas_with_its_name),
                                       cmocka_unit_test(shares_of_a_pose_stay_together),
                                       cmocka_unit_test(voxels_have_the_name_of_their_atlas),
                                       cmocka_unit_test(what_does_not_belong_together_is_not_joined),
                                       cmocka_unit_test(a_moved_atlas_is_joined_with_moved_ones_only),
                                       cmocka_unit_test(some_reports_have_no_such_column),
                                       cmocka_unit_test(every_failing_allocation_is_survived)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
