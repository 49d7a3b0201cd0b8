/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports about bundles (Eq. 19): columns that tables have for them alone. The numbers are those of the four lines of
 * tract_scene.h: a cylinder of 5 mm about the axis z holds 10 mm of the first and 8 mm (3-4-5) of the second. */
#include "test.h"
#include "tract_scene.h"

#include <stdlib.h>
#include <string.h>

static char *report_of(const conus_atlas *atlas, conus_format format, double ball)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_report *report = NULL;
    conus_pose pose;
    const char *text = NULL;
    size_t size = 0;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = 5};
    const conus_report_options as = {.format = format, .command = "conus x"};
    const double middle[3] = {0, 4, 30};
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 0}, (double[]){0, 0, 1}, NULL));
    assert_ok(ball > 0 ? conus_select_ball(&selection, selector, middle, ball)
                       : conus_select(&selection, selector, &pose, 0));
    assert_ok(conus_report_create(&report, selector, &as));
    assert_ok(conus_report_add(report, "q1", selection));
    assert_ok(conus_report_text(&text, &size, report));
    char *copy = strdup(text);
    assert_non_null(copy);
    conus_report_destroy(report);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return copy;
}

static void assert_has(const char *text, const char *part)
{
    if (!strstr(text, part)) {
        fail_msg("'%s' is not in:\n%s", part, text);
    }
}

/* The nearest point, (0, 0, 30), is in the middle of its line. The rows of what is no bundle have n/a. */
static void tables_have_columns_for_bundles(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    char *text = report_of(atlas, CONUS_FORMAT_TSV, 0);
    assert_has(text, "\tunoccluded\tstreamlines\tstreamlines_total\tlength_mm\tnear_x\tnear_y\tnear_z\talong"
                     "\tcontact_value\n");
    assert_has(text, "q1\tbundle\t1\tnear\tn/a\t1\t");
    assert_has(text, "\t2\t3\t18\t0\t0\t30\t0.5\tn/a\n");
    assert_has(text, "\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\n"); /* unassigned, the last row */
    assert_null(strstr(text, "far"));
    free(text);
    conus_atlas_destroy(atlas);
}

static void json_has_them(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    char *text = report_of(atlas, CONUS_FORMAT_NDJSON, 0);
    assert_has(text,
               "\"streamlines\":2,\"streamlines_total\":3,\"length_mm\":18,\"near_x\":0,\"near_y\":0,\"near_z\":30,"
               "\"along\":0.5,");
    assert_has(text, "\"streamlines\":null,\"streamlines_total\":null,\"length_mm\":null,");
    free(text);
    conus_atlas_destroy(atlas);
}

static void people_read_them(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    char *text = report_of(atlas, CONUS_FORMAT_TABLE, 0);
    assert_has(text, "        streamlines     length   along\n");
    assert_has(text, "        in the cone         mm  bundle\n");
    assert_has(text, "              2 of 3       18.0    0.50\n");
    free(text);
    text = report_of(atlas, CONUS_FORMAT_TABLE, 5); /* 2 * 3 and 2 sqrt(25 - 1) mm, the nearest 1 mm away */
    assert_has(text, "        in the ball         mm  bundle\n");
    assert_has(text, "              2 of 3       15.8    0.30\n");
    free(text);
    conus_atlas_destroy(atlas);
}

/* Hidden bundles are as if they were not there, and so are their columns. */
static void without_bundles_nothing_changes(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    const bool hidden[3] = {false, true, false};
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    char *text = report_of(atlas, CONUS_FORMAT_TSV, 0);
    assert_has(text, "\tstreamlines\t"); /* of the one that is left */
    free(text);
    conus_atlas_destroy(atlas);
    atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    text = report_of(atlas, CONUS_FORMAT_TSV, 0);
    assert_has(text, "\tunoccluded\tcontact_value\n");
    free(text);
    text = report_of(atlas, CONUS_FORMAT_TABLE, 0);
    assert_has(text, "     value\n");
    free(text);
    conus_atlas_destroy(atlas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_have_columns_for_bundles),
        cmocka_unit_test(json_has_them),
        cmocka_unit_test(people_read_them),
        cmocka_unit_test(without_bundles_nothing_changes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
