/* SPDX-License-Identifier: BSD-3-Clause */
/* The lists of hits: cells against the tables of the report writers, order, columns in sessions, exported files. */
#include "viewer/model/columns.h"
#include "viewer/session/session.h"

#include "builders/area_rows.h"
#include "conus/own.h"
#include "session_words.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A phantom, the labels of another one as the values of a pathway, and a bundle; NULL = none. */
static void load(struct viewer *out, const char *kind, const char *tract, const conus_polylines *lines)
{
    conus_atlas *atlas = NULL;
    char path[600];
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch(kind));
    assert_ok(conus_phantom_write(kind, folder, NULL));
    snprintf(path, sizeof path, "%s/%s.nii.gz", folder, kind);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    if (tract) {
        const conus_pathway_options pathway = {.name = "tract", .threshold = 3};
        char file[600];
        assert_ok(conus_phantom_write(tract, folder, NULL));
        snprintf(file, sizeof file, "%s/%s.nii.gz", folder, tract);
        assert_ok(conus_atlas_add_pathway(atlas, file, &pathway));
    }
    if (lines) {
        assert_ok(conus_atlas_add_polylines(atlas, lines, NULL));
    }
    assert_ok(viewer_create(out, &(struct view_source){.atlas = atlas, .path = "phantom"}, 1, NULL, NULL, NULL));
}

/* Aims from a ball around the brain towards points near its middle. */
static void aim_anywhere(struct viewer *viewer, unsigned *seed)
{
    double from[3];
    double along[3];
    double length = 0;
    for (int a = 0; a < 3; a++) {
        from[a] = (double)rand_r(seed) / RAND_MAX - 0.5;
        length += from[a] * from[a];
    }
    for (int a = 0; a < 3; a++) {
        from[a] *= 1.5 * viewer->radius / sqrt(length);
        along[a] = 20 * ((double)rand_r(seed) / RAND_MAX - 0.5) - from[a];
        from[a] += viewer->centre[a];
    }
    tool_aim_along(viewer, FIRST_TOOL, from, along);
}

enum { CELLS = 64 };

/* Splits a line of TSV into cells, in place; returns the next line. */
static char *cut(char *cells[CELLS], size_t *count, char *line)
{
    char *end = line + strcspn(line, "\n");
    char *next = *end ? end + 1 : end;
    *end = '\0';
    *count = 0;
    for (char *cell; (cell = strsep(&line, "\t"));) {
        cells[(*count)++] = cell;
    }
    return next;
}

static void check_row(const struct viewer *viewer, const conus_result *result, char *const *names, char *const *cells,
                      size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        char text[RESULT_TEXT];
        size_t column = result_find(names[i]);
        bool has_words = column == RESULT_NAME && !result->object;
        if (column < RESULT_COLUMNS) {
            const char *exact = result_exact(text, viewer, viewer->drawn, column, result);
            found++;
            assert_string_equal(exact, has_words ? "(nothing hit)" : cells[i]);
        }
    }
    assert_int_equal(found, conus_atlas_tractogram_count(viewer->drawn->atlas) ? RESULT_COLUMNS : RESULT_STREAMLINES);
}

/* The cells have all digits of the library's TSV, in the same rows. */
static void check_against_tsv(struct viewer *viewer)
{
    char *names[CELLS];
    char *cells[CELLS];
    size_t columns;
    size_t count;
    const conus_selection *selection = viewer_selection(viewer);
    char *text = viewer_results_text(viewer);
    char *line = cut(names, &columns, text);
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        line = cut(cells, &count, line);
        assert_int_equal(count, columns);
        check_row(viewer, conus_selection_result(selection, i), names, cells, columns);
    }
    assert_string_equal(line, "");
    free(text);
}

/* The cells show the digits of the table for people, whose columns come in this order; but its share of 0 is "behind".
 */
static void check_against_table(struct viewer *viewer, const size_t *columns, size_t count)
{
    conus_report *report = NULL;
    const char *text;
    size_t size;
    assert_ok(viewer_report(&report, viewer, FIRST_TOOL, "table"));
    assert_ok(conus_report_text(&text, &size, report));
    const char *at = strstr(text, "rank  name");
    assert_non_null(at);
    at = strchr(strchr(at, '\n') + 1, '\n') + 1; /* behind the two lines of headings */
    for (size_t i = 0; conus_selection_result(viewer_selection(viewer), i)->object; i++) {
        for (size_t c = 0; c < count; c++) {
            char cell[RESULT_TEXT];
            const char *wanted = result_cell(cell, viewer, viewer->drawn, columns[c],
                                             conus_selection_result(viewer_selection(viewer), i));
            at += strspn(at, " ");
            wanted = strcmp(wanted, "behind") == 0 ? "0.0 %" : wanted;
            assert_memory_equal(at, wanted, strlen(wanted));
            at += strlen(wanted);
            assert_true(*at == ' ' || *at == '\n');
        }
        assert_int_equal(*at, '\n');
        at++;
    }
    conus_report_destroy(report);
}

static void cells_are_those_of_conus_query(void **state)
{
    static const size_t visible[] = {RESULT_RANK,     RESULT_NAME,   RESULT_LABEL, RESULT_SHARE, RESULT_PIXELS,
                                     RESULT_DISTANCE, RESULT_OFFSET, RESULT_X,     RESULT_Y,     RESULT_Z};
    static const size_t all[] = {RESULT_RANK,   RESULT_NAME,    RESULT_LABEL,    RESULT_SHARE,
                                 RESULT_PIXELS, RESULT_PIERCED, RESULT_ENTRY,    RESULT_EXIT,
                                 RESULT_PATH,   RESULT_VOLUME,  RESULT_FRACTION, RESULT_MEAN};
    struct viewer viewer;
    unsigned seed = 17;
    size_t rows = 0;
    (void)state;
    load(&viewer, "slabs", "tubes", NULL);
    for (int i = 0; i < 50; i++) {
        bool layers = i >= 25; /* one selector for each half */
        viewer.frame.space = i % 3 ? CONUS_SPACE_RAS : CONUS_SPACE_LPS;
        viewer.tools[FIRST_TOOL].angle = 5 + i;
        viewer.cone.options.layers = layers ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE;
        aim_anywhere(&viewer, &seed);
        check_against_tsv(&viewer);
        check_against_table(&viewer, layers ? all : visible, layers ? sizeof all / sizeof *all : 10);
        rows += conus_selection_count(viewer_selection(&viewer));
    }
    assert_true(rows > 150);
    viewer_finish(&viewer);
}

/* A bundle through the slabs has cells for its streamlines in the cone, their length and place; an area has n/a
 * there. */
static void cells_of_bundles_are_those_of_conus_query(void **state)
{
    static const double points[4][3] = {{-40, 0, 0}, {40, 0, 0}, {0, -40, 0}, {0, 40, 0}};
    static const uint64_t first[] = {0, 2, 4};
    const conus_polylines lines = {
        .points = points, .type = CONUS_SCALAR_FLOAT64, .point_count = 4, .first = first, .streamline_count = 2};
    struct viewer viewer;
    unsigned seed = 18;
    bool comes_in = false;
    (void)state;
    load(&viewer, "slabs", "tubes", NULL);
    assert_false(result_is_offered(&viewer, RESULT_ALONG));
    viewer_finish(&viewer);
    load(&viewer, "slabs", NULL, &lines);
    for (int i = 0; i < 10; i++) {
        viewer.tools[FIRST_TOOL].angle = 10;
        viewer.cone.options.layers = CONUS_LAYERS_ALL;
        aim_anywhere(&viewer, &seed);
        check_against_tsv(&viewer);
        for (size_t r = 0; r < conus_selection_count(viewer_selection(&viewer)); r++) {
            comes_in = comes_in || conus_selection_result(viewer_selection(&viewer), r)->streamlines > 0;
        }
    }
    assert_true(comes_in);
    viewer_finish(&viewer);
}

static const conus_result *row_at(const struct viewer *viewer, size_t place)
{
    size_t *order = result_order(viewer, viewer->drawn, view_atlas_selection(viewer->drawn, FIRST_TOOL));
    const conus_result *result = conus_selection_result(viewer_selection(viewer), order[place]);
    free(order);
    return result;
}

/* With all layers an occluded object has no contact: it comes last in both directions, but before `unassigned`. */
static void rows_have_the_order_of_a_column(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "nested", NULL, NULL);
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    viewer.tools[FIRST_TOOL].angle = 30;
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){0, 90, 0}, (double[]){0, -1, 0});
    assert_int_equal(conus_selection_count(viewer_selection(&viewer)), 4);
    result_order_by(&viewer, RESULT_PATH); /* the longest way inside is the outermost shell's: 2 (24 - 16) mm */
    assert_int_equal(row_at(&viewer, 3)->object, 0);
    assert_true(row_at(&viewer, 0)->path >= row_at(&viewer, 1)->path);
    assert_true(row_at(&viewer, 1)->path >= row_at(&viewer, 2)->path);
    result_order_by(&viewer, RESULT_PATH);
    assert_true(row_at(&viewer, 0)->path <= row_at(&viewer, 1)->path);
    assert_int_equal(row_at(&viewer, 3)->object, 0);
    result_order_by(&viewer, RESULT_PATH);
    assert_int_equal(viewer.list.order, RESULT_RANK);
    assert_false(viewer.list.reversed);
    for (int way = 0; way < 2; way++) {
        result_order_by(&viewer, RESULT_Y);
        assert_int_equal(row_at(&viewer, 0)->object, 1); /* the only one that is seen */
        assert_int_equal(row_at(&viewer, 3)->object, 0);
    }
    result_order_by(&viewer, RESULT_NAME);
    const char *first = conus_atlas_object(viewer.drawn->atlas, row_at(&viewer, 0)->object)->name;
    result_order_by(&viewer, RESULT_NAME);
    const char *last = conus_atlas_object(viewer.drawn->atlas, row_at(&viewer, 0)->object)->name;
    assert_true(strcmp(first, last) < 0);
    viewer_finish(&viewer);
}

static bool has(const struct viewer *viewer, size_t column)
{
    size_t shown[RESULT_COLUMNS];
    size_t count = result_shown(shown, viewer);
    bool found = false;
    for (size_t i = 0; i < count; i++) {
        found = found || shown[i] == column;
    }
    return found;
}

static void columns_are_chosen(void **state)
{
    struct viewer viewer;
    char *wanted[] = {"pixels", "path_mm"};
    char *unknown[] = {"pixels", "colour"};
    (void)state;
    load(&viewer, "nested", NULL, NULL);
    assert_true(has(&viewer, RESULT_X) && has(&viewer, RESULT_DISTANCE) && !has(&viewer, RESULT_SCORE));
    assert_string_equal(result_heading(&viewer, RESULT_DISTANCE), "distance mm");
    assert_string_equal(result_heading(&viewer, RESULT_ENTRY), "entry mm");
    viewer.cone.options.score = "centre";
    assert_true(has(&viewer, RESULT_SCORE));
    result_show(&viewer, RESULT_X, false);
    viewer.cone.options.score = "share"; /* the columns shown when one was removed stay */
    assert_true(!has(&viewer, RESULT_X) && has(&viewer, RESULT_Y) && has(&viewer, RESULT_SCORE));
    assert_true(result_choose(&viewer, wanted, 2));
    assert_true(has(&viewer, RESULT_NAME) && has(&viewer, RESULT_PIXELS) && !has(&viewer, RESULT_SHARE));
    assert_false(has(&viewer, RESULT_PATH)); /* there are first hits only */
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    assert_true(has(&viewer, RESULT_PATH));
    assert_false(result_choose(&viewer, unknown, 2));
    assert_true(has(&viewer, RESULT_PATH));
    result_show(&viewer, RESULT_NAME, false);
    assert_true(has(&viewer, RESULT_NAME));
    assert_true(result_choose(&viewer, NULL, 0));
    assert_true(has(&viewer, RESULT_ENTRY) && !has(&viewer, RESULT_PIXELS));
    viewer_finish(&viewer);
}

static void sessions_keep_the_list(void **state)
{
    struct viewer viewer;
    struct window window = {.viewer = &viewer, .screen.enlarged = -1};
    char why[PROPERTY_REASON];
    (void)state;
    load(&viewer, "nested", NULL, NULL);
    result_show(&viewer, RESULT_MAX, true);
    result_order_by(&viewer, RESULT_OFFSET);
    result_order_by(&viewer, RESULT_OFFSET);
    viewer.list.format = 2;
    struct result_list kept = viewer.list;
    char *text = session_text(&window);
    viewer.list = (struct result_list){0};
    assert_true(session_parse(&window, text, strlen(text), why));
    assert_int_equal(viewer.list.columns, kept.columns);
    assert_int_equal(viewer.list.order, RESULT_OFFSET);
    assert_true(viewer.list.reversed);
    assert_int_equal(viewer.list.format, 2);
    static const char *const wrong[][2] = {{"\"max_value\"", "\"max_valve\""},
                                           {"\"order\": \"offset_deg\"", "\"order\": \"offset_rad\""},
                                           {"\"reversed\": true", "\"reversed\":    1"},
                                           {"\"export\": \"JSON\"", "\"export\": \"JSOM\""}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char *changed = strdup(text);
        char *at = strstr(changed, wrong[i][0]);
        assert_non_null(at);
        memcpy(at, wrong[i][1], strlen(wrong[i][1]));
        viewer.list = (struct result_list){.order = RESULT_LABEL};
        assert_false(session_parse(&window, changed, strlen(changed), why));
        assert_non_null(strstr(why, "session: results: "));
        assert_int_equal(viewer.list.order, RESULT_LABEL);
        free(changed);
    }
    free(text);
    viewer_finish(&viewer);
}

static void failing_exports_are_reported(void **state)
{
    struct viewer viewer;
    char why[EXPORT_WHY];
    (void)state;
    load(&viewer, "nested", NULL, NULL);
    assert_false(export_results(&viewer, "/nowhere/at/all.tsv", why));
    assert_non_null(strstr(why, "/nowhere/at/all"));
    assert_false(export_results(&viewer, "hits.xlsx", why));
    assert_non_null(strstr(why, "hits.xlsx"));
    viewer_finish(&viewer);
}

static void assert_headline(struct viewer *viewer, const char *what, const char *more)
{
    struct headline headline;
    headline_find(&headline, viewer);
    assert_string_equal(headline.what, what);
    assert_string_equal(headline.more, more);
}

/* The ball of 20 mm in two halves: rays in the plane between them would be as many to the left as to the right, and
 * the axis from y = 70 comes in after 50 mm. A needle beside the plane meets one half, behind which there is none. */
static void the_answer_names_all_that_are_as_good(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "sphere", NULL, NULL);
    assert_headline(&viewer, "No answer yet", " ");
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){0, 70, 0}, (const double[]){0, -1, 0});
    assert_headline(&viewer, "Sphere", "100 % of the cone \u00b7\u00a050.0 mm from the start");
    for (int x = 0; conus_selection_result(viewer_selection(&viewer), 0)->share >= 1; x++) {
        tool_aim_along(&viewer, FIRST_TOOL, (const double[]){x / 8.0, 70, 0}, (const double[]){0, -1, 0});
    }
    struct headline headline;
    headline_find(&headline, &viewer); /* some rays pass by it */
    assert_memory_equal(headline.more, "99.", 3);
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){0, 70, 0}, (const double[]){0, -1, 0});
    viewer.cone.options.radius = 1;
    tool_reselect(&viewer);
    assert_headline(&viewer, "Sphere", "100 % of the cylinder \u00b7\u00a050.0 mm from the start");
    viewer.cone.one_ray = true;
    tool_reselect(&viewer);
    assert_headline(&viewer, "Sphere", "on the axis \u00b7\u00a050.0 mm from the start");
    viewer.cone.one_ray = false;
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){0, 70, 0}, (const double[]){0, 1, 0});
    assert_headline(&viewer, "Nothing is hit", "no area lies in the cylinder");
    viewer_finish(&viewer);
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_scratch("sphere/sphere.nii.gz"), NULL));
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = "halves"}, 1, NULL, NULL, NULL));
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){0, 70, 0}, (const double[]){0, -1, 0});
    assert_headline(&viewer, "Sphere left and Sphere right",
                    "50 % of the cone each \u00b7\u00a050.0 mm from the start");
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){-6, 70, 0}, (const double[]){0, -1, 0});
    headline_find(&headline, &viewer);
    assert_string_equal(headline.what, "Sphere left");
    assert_non_null(strstr(headline.more, " mm from the start \u00b7\u00a0left"));
    viewer_finish(&viewer);
}

/* The ball without its table of labels is called by its number, 1; in the file it stays that. */
static void a_number_has_its_atlas_before_it(void **state)
{
    struct viewer viewer;
    conus_atlas *atlas = NULL;
    char text[RESULT_TEXT];
    (void)state;
    assert_ok(conus_phantom_write("sphere", test_scratch("numbers"), NULL));
    assert_int_equal(remove(test_scratch("numbers/sphere.tsv")), 0);
    for (int split = 0; split < 2; split++) {
        assert_ok(conus_atlas_load(&atlas, test_scratch("numbers/sphere.nii.gz"), NULL));
        assert_ok(conus_atlas_set_hemispheres(atlas, split ? CONUS_HEMISPHERES_SPLIT : CONUS_HEMISPHERES_AS_IS));
        const struct view_source source = {.atlas = atlas, .path = "maps/brodmann.nii.gz"};
        assert_ok(viewer_create(&viewer, &source, 1, NULL, NULL, NULL));
        tool_aim_along(&viewer, FIRST_TOOL, (const double[]){0, 70, 0}, (const double[]){0, -1, 0});
        assert_headline(&viewer, split ? "Brodmann 1 left and Brodmann 1 right" : "Brodmann 1",
                        split ? "50 % of the cone each \u00b7\u00a050.0 mm from the start"
                              : "100 % of the cone \u00b7\u00a050.0 mm from the start");
        const conus_result *best = conus_selection_result(viewer_selection(&viewer), 0);
        assert_string_equal(result_cell(text, &viewer, viewer.drawn, RESULT_NAME, best), split ? "1 left" : "1");
        viewer_finish(&viewer);
    }
}

/* Exchanged or not, A_L is met after 9.5 mm where it is: at x = 1 or -1. */
static void no_side_is_told_where_names_and_places_differ(void **state)
{
    static const double x[2] = {-1, 1};
    (void)state;
    for (int exchanged = 0; exchanged < 2; exchanged++) {
        struct viewer viewer;
        conus_atlas *atlas = NULL;
        struct headline headline;
        assert_ok(area_rows_pairs(&atlas, exchanged));
        assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = "six"}, 1, NULL, NULL, NULL));
        tool_aim_along(&viewer, FIRST_TOOL, (const double[]){x[exchanged], -1, 10}, (const double[]){0, 0, -1});
        headline_find(&headline, &viewer);
        assert_string_equal(headline.what, "A_L");
        assert_int_equal(strstr(headline.more, " \u00b7\u00a0left") == NULL, exchanged);
        assert_int_equal(conus_atlas_exchanged(atlas) != NULL, exchanged);
        assert_int_equal(view_atlas_side(viewer.drawn, 1), exchanged ? ' ' : 'L');
        viewer_finish(&viewer);
    }
}

TEST_GROUP(results)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_those_of_conus_query),
        cmocka_unit_test(cells_of_bundles_are_those_of_conus_query),
        cmocka_unit_test(rows_have_the_order_of_a_column),
        cmocka_unit_test(columns_are_chosen),
        cmocka_unit_test(sessions_keep_the_list),
        cmocka_unit_test(failing_exports_are_reported),
        cmocka_unit_test(the_answer_names_all_that_are_as_good),
        cmocka_unit_test(a_number_has_its_atlas_before_it),
        cmocka_unit_test(no_side_is_told_where_names_and_places_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
