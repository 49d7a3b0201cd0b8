/* SPDX-License-Identifier: BSD-3-Clause */
/* From hand-made evidence to results, ranks and reports. The engine here is scripted, so that every number is known. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "selection/report/report.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* 4 x 4 pixels; the circle holds the 12 that are not corners. Object 1 has two pixels, 2 has one and a corner. */
static const uint32_t seen[16] = {2, 2, 0, 0, /* row 0, the device's bottom */
                                  0, 1, 0, 0, /**/
                                  0, 0, 1, 0, /**/
                                  0, 0, 0, 0};

static conus_status trace_script(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    (void)engine;
    (void)cone;
    for (size_t i = 0; i < 16; i++) {
        if (seen[i]) {
            out->object[i] = seen[i];
            out->distance[i] = 100 - (double)i;
            out->voxel[i] = seen[i] == 1 ? 1 : 3;
        }
    }
    return CONUS_OK;
}

static void destroy_nothing(struct engine *engine)
{
    (void)engine;
}

static const struct engine_functions script_functions = {.trace = trace_script, .destroy = destroy_nothing};

struct fixture {
    conus_atlas *atlas;
    struct engine engine;
    conus_selector selector;
    conus_selection *selection;
};

static void name_area(struct label_table *table, uint32_t number, const char *name)
{
    struct label *label = label_table_add(table, number);
    assert_non_null(label);
    assert_ok(label_set_text(&label->name, text_from(name)));
}

static int set_up(void **state)
{
    static struct fixture fixture;
    static const uint32_t labels[4] = {0, 10, 20, 4000000000U};
    conus_volume_info info = {.role = CONUS_ROLE_PARCELLATION, .path = "a.nii", .dim = {4, 1, 1}};
    struct label_table table = {0};
    struct notes notes = {0};
    fixture = (struct fixture){.engine = {&script_functions, "script"}};
    mat4_identity(info.world_from_voxel);
    for (int i = 0; i < 3; i++) {
        info.spacing[i] = 1;
    }
    name_area(&table, 10, "ten");
    name_area(&table, 4000000000U, "far \"quoted\"");
    assert_ok(label_table_sort(&table, &notes));
    assert_ok(atlas_create(&fixture.atlas, &info, labels, &table, "here", &notes));
    label_table_finish(&table);
    fixture.selector =
        (conus_selector){.atlas = fixture.atlas, .engine = &fixture.engine, .options = {.resolution = 4}};
    assert_ok(ranking_parse(&fixture.selector.ranking, NULL));
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 50}, (double[]){0, 0, -1}, NULL));
    assert_ok(conus_select(&fixture.selection, &fixture.selector, &pose, 60));
    *state = &fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    conus_selection_destroy(fixture->selection);
    aperture_finish(&fixture->selector.aperture);
    tally_finish(&fixture->selector.tally);
    conus_atlas_destroy(fixture->atlas);
    return 0;
}

/* Eq. 4: weights by hand; Eq. 11: of object 1's two pixels with one radius, the nearer. */
static void results_follow_from_the_pixels(void **state)
{
    struct fixture *fixture = *state;
    const double t = tan(radians_from_degrees(30));
    const double inner = pow(1 + t * t * 0.125, -1.5); /* r^2 = 2 (1/4)^2 */
    const double outer = pow(1 + t * t * 0.625, -1.5); /* r^2 = (1/4)^2 + (3/4)^2 */
    const double total = 4 * inner + 8 * outer;
    assert_int_equal(conus_selection_count(fixture->selection), 3);
    const conus_result *one = conus_selection_result(fixture->selection, 0);
    assert_int_equal(one->object, 1);
    assert_int_equal(one->kind, CONUS_KIND_AREA);
    assert_int_equal(one->rank, 1);
    assert_int_equal(one->pixels, 2);
    assert_near(one->share, 2 * inner / total, 1e-12);
    assert_near(one->score, one->share, 0);
    assert_near(one->centre_px, sqrt(0.125) * 2, 1e-12);
    assert_near(one->offset, degrees_from_radians(atan(sqrt(0.125) * t)), 1e-12);
    assert_near(one->distance, 90, 0);
    double ray[3] = {0.25 * t, 0.25 * t, -1};
    vec3_normalise(ray, ray);
    assert_near(one->contact[0], 90 * ray[0], 1e-9);
    assert_near(one->contact[1], 90 * ray[1], 1e-9);
    assert_near(one->contact[2], 50 + 90 * ray[2], 1e-9);
    const conus_result *two = conus_selection_result(fixture->selection, 1);
    assert_int_equal(two->object, 2);
    assert_int_equal(two->pixels, 1); /* its corner is outside the circle */
    assert_near(two->distance, 99, 0);
    const conus_result *nothing = conus_selection_result(fixture->selection, 2);
    assert_int_equal(nothing->kind, CONUS_KIND_UNASSIGNED);
    assert_int_equal(nothing->pixels, 9);
    assert_near(one->share + two->share + nothing->share, 1, 1e-12);
}

/* Eq. 12: each score orders by its measure. */
static void scores_order_by_their_measure(void **state)
{
    struct fixture *fixture = *state;
    struct ranking ranking;
    struct statistics statistics = {0};
    const struct score_view view = {.cone = &fixture->selection->cone, .cone_pixels = 12};
    const struct gathering gathering = {.atlas = fixture->atlas,
                                        .cone = &fixture->selection->cone,
                                        .aperture = &fixture->selector.aperture,
                                        .evidence = &fixture->selection->evidence};
    assert_ok(statistics_gather(&statistics, &gathering, &fixture->selector.tally));
    assert_ok(ranking_parse(&ranking, "distance"));
    score_rank(&statistics, &ranking, &view);
    assert_int_equal(statistics.results[0].object, 1);
    assert_near(statistics.results[0].score, -90, 0);
    assert_ok(ranking_parse(&ranking, "centre"));
    score_rank(&statistics, &ranking, &view);
    assert_int_equal(statistics.results[0].object, 1);
    assert_near(statistics.results[0].score,
                1 - atan(sqrt(0.125) * tan(radians_from_degrees(30))) / radians_from_degrees(30), 1e-12);
    assert_fails(ranking_parse(&ranking, "best"), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "share, centre, distance"));
    statistics_finish(&statistics);
}

static const char *text_in(conus_report *report)
{
    const char *text;
    size_t size;
    assert_ok(conus_report_text(&text, &size, report));
    assert_int_equal(strlen(text), size);
    return text;
}

static conus_report *report_in(struct fixture *fixture, const char *format, conus_space space)
{
    conus_report *report = NULL;
    const conus_report_options options = {.format = format, .space = space, .all_voxels = true, .command = "conus x"};
    assert_ok(conus_report_create(&report, &fixture->selector, &options));
    assert_ok(conus_report_add(report, "q1", fixture->selection));
    return report;
}

static void tsv_has_the_contract_s_columns(void **state)
{
    conus_report *report = report_in(*state, "tsv", CONUS_SPACE_RAS);
    const char *text = text_in(report);
    const char *header = "query\tkind\tindex\tname\tabbreviation\trank\tscore\tpixels\tshare\tpierced\tcenter_px\t"
                         "offset_deg\tdistance_mm\tcontact_x\tcontact_y\tcontact_z\tentry_mm\texit_mm\tpath_mm\t"
                         "volume_mm3\tfraction\tmean_value\tmax_value\tcontact_value\n";
    assert_int_equal(strncmp(text, header, strlen(header)), 0);
    text += strlen(header);
    assert_int_equal(strncmp(text, "q1\tarea\t10\tten\tn/a\t1\t", 21), 0);
    assert_non_null(strstr(text, "\nq1\tarea\t20\t20\tn/a\t2\t")); /* called by its number */
    assert_non_null(strstr(text, "\nq1\tunassigned\tn/a\tunassigned\tn/a\tn/a\tn/a\t9\t"));
    conus_report_destroy(report);
}

static double contact_x_of_first_row(const char *tsv)
{
    struct text rest = text_from(tsv);
    struct text line;
    struct text field;
    double x;
    bool more = true;
    text_line(&rest, &line);
    text_line(&rest, &line);
    for (int i = 0; i <= 13; i++) {
        text_field(&line, '\t', &more, &field);
    }
    assert_true(text_to_double(field, &x));
    return x;
}

static void lps_reports_negate_x_and_y(void **state)
{
    conus_report *ras = report_in(*state, "tsv", CONUS_SPACE_RAS);
    conus_report *lps = report_in(*state, "tsv", CONUS_SPACE_LPS);
    double x = contact_x_of_first_row(text_in(ras));
    assert_true(x > 1);
    assert_near(contact_x_of_first_row(text_in(lps)), -x, 0);
    conus_report_destroy(ras);
    conus_report_destroy(lps);
}

static void json_has_the_same_keys_and_provenance(void **state)
{
    conus_report *report = report_in(*state, "json", CONUS_SPACE_RAS);
    const char *text = text_in(report);
    const char *const parts[] = {"\"name\": \"ten\"",        "\"pierced\": null",   "\"CommandLine\": \"conus x\"",
                                 "\"orientation\": \"RAS\"", "\"angle_deg\": 60.0", "\"cone_pixels\": 12"};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        assert_non_null(strstr(text, parts[i]));
    }
    conus_report_destroy(report);
    report = report_in(*state, "ndjson", CONUS_SPACE_RAS);
    text = text_in(report);
    assert_ptr_equal(strstr(text, "{\"query\":\"q1\",\"kind\":\"area\",\"index\":10,"), text);
    conus_report_destroy(report);
}

static void sidecar_describes_every_column(void **state)
{
    conus_report *report = report_in(*state, "tsv", CONUS_SPACE_RAS);
    const char *text;
    size_t size;
    assert_ok(conus_report_sidecar(&text, &size, report));
    struct report_columns columns;
    report_list_columns(&columns, report);
    for (size_t i = 0; i < columns.count; i++) {
        char key[64];
        snprintf(key, sizeof key, "\"%s\": {", columns.at[i]->name);
        assert_non_null(strstr(text, key));
    }
    conus_report_destroy(report);
}

static void voxels_are_listed_once(void **state)
{
    conus_report *report = report_in(*state, "tsv", CONUS_SPACE_RAS);
    const char *text;
    size_t size;
    assert_ok(conus_report_voxels(&text, &size, report));
    assert_string_equal(text, "query\tpathway\ti\tj\tk\tx\ty\tz\tvalue\tdistance_mm\tkind\tindex\n"
                              "q1\tten\t1\t0\t0\t1\t0\t0\t10\t90\tarea\t10\n"
                              "q1\t20\t3\t0\t0\t3\t0\t0\t20\t99\tarea\t20\n");
    conus_report_destroy(report);
}

static void table_reads_well(void **state)
{
    conus_report *report = report_in(*state, "table", CONUS_SPACE_RAS);
    const char *text = text_in(report);
    const char *const parts[] = {
        "cone of 60 degrees from (0.00, 0.00, 50.00)", "ten",           "(nothing hit)",
        "12 pixels in the cone (4 x 4 buffer)",        "engine script", "\natlas a.nii, placed by "};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        assert_non_null(strstr(text, parts[i]));
    }
    conus_report_destroy(report);
}

static conus_status select_and_report(void *data)
{
    struct fixture *fixture = data;
    static const char *const formats[] = {"table", "tsv", "json", "ndjson"};
    conus_selection *selection = NULL;
    conus_status status =
        conus_select(&selection, &fixture->selector, &fixture->selection->cone.pose, degrees_from_radians(1));
    for (size_t i = 0; !status && i < sizeof formats / sizeof formats[0]; i++) {
        conus_report *report = NULL;
        const conus_report_options options = {.format = formats[i], .all_voxels = true};
        const char *text;
        size_t size;
        status = conus_report_create(&report, &fixture->selector, &options);
        status = status ? status : conus_report_add(report, "1", selection);
        status = status ? status : conus_report_text(&text, &size, report);
        status = status ? status : conus_report_voxels(&text, &size, report);
        status = status ? status : conus_report_sidecar(&text, &size, report);
        conus_report_destroy(report);
    }
    conus_selection_destroy(selection);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    test_every_allocation(select_and_report, *state);
}

static void bad_queries_are_refused(void **state)
{
    struct fixture *fixture = *state;
    conus_selection *selection = NULL;
    conus_pose pose = fixture->selection->cone.pose;
    assert_fails(conus_select(&selection, &fixture->selector, &pose, 0), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_select(&selection, &fixture->selector, &pose, degrees_from_radians(MATH3_PI)),
                 CONUS_ERROR_ARGUMENT);
    pose.world_from_device[12] = NAN;
    assert_fails(conus_select(&selection, &fixture->selector, &pose, degrees_from_radians(1)), CONUS_ERROR_ARGUMENT);
    assert_null(selection);
}

static void nothing_has_no_results(void **state)
{
    struct fixture *fixture = *state;
    double position[3] = {0};
    assert_int_equal(conus_selection_count(NULL), 0);
    assert_null(conus_selection_result(NULL, 0));
    assert_int_equal(conus_selection_evidence(NULL).resolution, 0);
    conus_selection_position(position, NULL, 0);
    assert_true(isnan(position[0]));
    conus_selection_position(position, fixture->selection, 16); /* behind the last pixel */
    assert_true(isnan(position[2]));
    assert_string_equal(conus_selector_engine(NULL), "");
    assert_null(conus_score(1000));
}

TEST_GROUP(selection)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(results_follow_from_the_pixels),
        cmocka_unit_test(scores_order_by_their_measure),
        cmocka_unit_test(tsv_has_the_contract_s_columns),
        cmocka_unit_test(lps_reports_negate_x_and_y),
        cmocka_unit_test(json_has_the_same_keys_and_provenance),
        cmocka_unit_test(sidecar_describes_every_column),
        cmocka_unit_test(voxels_are_listed_once),
        cmocka_unit_test(table_reads_well),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(bad_queries_are_refused),
        cmocka_unit_test(nothing_has_no_results),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
