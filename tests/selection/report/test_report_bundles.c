/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports about bundles (Eq. 19): the columns that only bundles have. The numbers are those of the four lines of
 * tract_scene.h: a cylinder of 5 mm about the axis z holds 10 mm of the first and 8 mm (3-4-5) of the second. And the
 * points of streamlines in conus_report_voxels(): in closed form, and against a loop over all points. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "selection/selection.h"
#include "test.h"
#include "tract_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *report_of(const conus_atlas *atlas, const char *format, double ball)
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

/* The nearest point, (0, 0, 30), is in the middle of its line. Rows of other objects have n/a. */
static void tables_have_columns_for_bundles(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    char *text = report_of(atlas, "tsv", 0);
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
    char *text = report_of(atlas, "ndjson", 0);
    assert_has(text,
               "\"streamlines\":2,\"streamlines_total\":3,\"length_mm\":18,\"near_x\":0,\"near_y\":0,\"near_z\":30,"
               "\"along\":0.5,");
    assert_has(text, "\"streamlines\":null,\"streamlines_total\":null,\"length_mm\":null,");
    free(text);
    conus_atlas_destroy(atlas);
}

/* Only TSV has the place of the nearest point along the bundle; means are shown only for columns with values. */
static void people_read_them(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    char *text = report_of(atlas, "table", 0);
    assert_has(text, "  of whole      streamlines     length\n");
    assert_has(text, "      area      in the cone         mm\n");
    assert_has(text, "           2 of 3       18.0\n");
    free(text);
    text = report_of(atlas, "table", 5); /* 2 * 3 and 2 sqrt(25 - 1) mm, the nearest 1 mm away */
    assert_has(text, "      in the ball         mm\n");
    assert_has(text, "           2 of 3       15.8\n");
    free(text);
    conus_atlas_destroy(atlas);
}

/* Hidden bundles are as if they had not been loaded, and have no columns. */
static void without_bundles_nothing_changes(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    const bool hidden[3] = {false, true, false};
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    char *text = report_of(atlas, "tsv", 0);
    assert_has(text, "\tstreamlines\t"); /* for the bundle that is left */
    free(text);
    conus_atlas_destroy(atlas);
    atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, "none"));
    text = report_of(atlas, "tsv", 0);
    assert_has(text, "\tunoccluded\tcontact_value\n");
    free(text);
    text = report_of(atlas, "table", 0);
    assert_has(text, "     value\n");
    free(text);
    conus_atlas_destroy(atlas);
}

static const char voxel_header[] = "query\tpathway\ti\tj\tk\tx\ty\tz\tvalue\tdistance_mm\tkind\tindex\n";

/* Streamlines along x at z = 30, with a point each mm from -14 to 14: 0 and 3 at y = 0, 2 at y = 3; 1 has no point, 4
 * the one point (0, 1, 30). At point 16, x = 2, a run ends and the next begins. "both" is 0, 1, 2 and 4, "second" 2 and
 * 3. */
static conus_atlas *points_atlas(void)
{
    static const uint32_t both[] = {0, 1, 2, 4};
    static const uint32_t second[] = {2, 3};
    conus_atlas *atlas = NULL;
    struct tract_builder builder;
    tract_begin(&builder);
    for (int k = 0; k < 5; k++) {
        int reach = k == 4 ? 0 : 14;
        double y = k == 2 ? 3 : k == 4 ? 1 : 0;
        for (int x = -reach; x <= reach && k != 1; x++) {
            tract_add_point(&builder, (double[]){x, y, 30});
        }
        tract_end_streamline(&builder);
    }
    tract_add_group(&builder.made, "both", both, 4);
    tract_add_group(&builder.made, "second", second, 2);
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "rest"));
    return atlas;
}

/* Adds a query with a cylinder of 5.5 mm about the axis z, with these layers. */
static conus_status add_tube(conus_report **report, const conus_atlas *atlas, conus_layers layers, const char *name)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    const conus_selector_options options = {.layers = layers, .radius = 5.5};
    const conus_report_options as = {.format = "tsv", .atlas = name};
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 0}, (double[]){0, 0, 1}, NULL));
    conus_status status = conus_selector_create(&selector, atlas, &options);
    status = status ? status : conus_select(&selection, selector, &pose, 0);
    status = status ? status : conus_report_create(report, selector, &as);
    status = status ? status : conus_report_add(*report, "q1", selection);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return status;
}

/* Writes the points of one line whose |x| is up to @p reach. */
static void put_line(struct buffer *out, const char *begin, int streamline, int y, int reach, const char *end)
{
    for (int x = -reach; x <= reach; x++) {
        buffer_format(out, "%s\t%d\t%d\tn/a\t%d\t%d\t30\tn/a\t%.9g\tbundle\t%s\n", begin, streamline, x + 14, x, y,
                      sqrt(x * x + y * y + 900), end);
    }
}

/* 5.5^2 = 30.25: up to x = 5 at y = 0, and to 4 at y = 3 (16 + 9). */
static void put_tube(struct buffer *out, const char *both, const char *second, bool has_both)
{
    if (has_both) {
        put_line(out, both, 0, 0, 5, "1");
        put_line(out, both, 2, 3, 4, "1");
        buffer_format(out, "%s\t4\t0\tn/a\t0\t1\t30\tn/a\t%.9g\tbundle\t1\n", both, sqrt(901));
    }
    put_line(out, second, 2, 3, 4, "2");
    put_line(out, second, 3, 0, 5, "2");
}

static void check_voxels(conus_report *report, struct buffer *wanted)
{
    const char *text = NULL;
    size_t size = 0;
    assert_ok(buffer_status(wanted));
    assert_ok(conus_report_voxels(&text, &size, report));
    assert_string_equal(text, wanted->data);
    assert_int_equal(size, wanted->size);
    buffer_finish(wanted);
}

/* Points are listed by bundle, streamline and point, each once in each of its bundles. Hidden bundles have none, and
 * neither have first hits. */
static void points_of_lines_in_a_cylinder(void **state)
{
    (void)state;
    conus_atlas *atlas = points_atlas();
    const bool hidden[3] = {false, true, false};
    for (int round = 0; round < 3; round++) {
        conus_report *report = NULL;
        struct buffer wanted = {0};
        assert_ok(conus_atlas_set_hidden(atlas, round == 1 ? hidden : NULL));
        assert_ok(add_tube(&report, atlas, round < 2 ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE, NULL));
        buffer_text(&wanted, voxel_header);
        if (round < 2) {
            put_tube(&wanted, "q1\tboth", "q1\tsecond", round == 0);
        }
        check_voxels(report, &wanted);
        conus_report_destroy(report);
    }
    conus_atlas_destroy(atlas);
}

/* Walks of up to 60 points; every second one is in the group "even", all others are "rest". */
static conus_atlas *walks_atlas(uint64_t *seed)
{
    conus_atlas *atlas = NULL;
    struct tract_builder builder;
    uint32_t members[40];
    tract_begin(&builder);
    for (uint32_t k = 0; k < 80; k++) {
        double at[3] = {test_random(seed, -30, 30), test_random(seed, -30, 30), test_random(seed, -30, 30)};
        members[k / 2] = k - k % 2;
        for (int left = (int)test_random(seed, 0, 60); left > 0; left--) {
            tract_add_point(&builder, at);
            for (int a = 0; a < 3; a++) {
                at[a] += test_random(seed, -2, 2);
            }
        }
        tract_end_streamline(&builder);
    }
    tract_add_group(&builder.made, "even", members, 40);
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "rest"));
    return atlas;
}

static void put_point(struct buffer *out, const char *begin, uint32_t object, const double p[3], const double from[3])
{
    double away[3];
    vec3_sub(away, p, from);
    buffer_text(out, begin);
    for (int n = 0; n < 4; n++) {
        buffer_text(out, n < 3 ? "\t" : "\tn/a\t");
        buffer_number(out, n < 3 ? p[n] : vec3_length(away));
    }
    buffer_format(out, "\tbundle\t%u\n", object);
}

/* Object 1 is the even streamlines, object 2 the others. */
static size_t put_all_points(struct buffer *out, const conus_atlas *atlas, const struct region *region)
{
    const struct tractogram *tractogram = &atlas->tractograms[0];
    size_t count = 0;
    for (uint32_t odd = 0; odd < 2; odd++) {
        for (uint64_t i = 0; i < tractogram->point_count; i++) {
            double p[3];
            char begin[64];
            uint32_t k = tractogram_streamline_of(tractogram, i);
            tractogram_point(p, tractogram, i);
            if (k % 2 == odd && region_has(region, p)) {
                snprintf(begin, sizeof begin, "q\t%s\t%u\t%d\tn/a", odd ? "rest" : "even", k,
                         (int)(i - tractogram->first[k]));
                put_point(out, begin, odd + 1, p, region->origin);
                count++;
            }
        }
    }
    return count;
}

static void points_of_walks_as_by_a_loop(void **state)
{
    (void)state;
    uint64_t seed = 5;
    size_t count = 0;
    conus_atlas *atlas = walks_atlas(&seed);
    conus_selector *selector = NULL;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    assert_ok(conus_selector_create(&selector, atlas, &options));
    for (int i = 0; i < 40; i++) {
        conus_report *report = NULL;
        conus_selection *selection = NULL;
        conus_pose pose;
        struct buffer wanted = {0};
        const double at[3] = {test_random(&seed, -40, 40), test_random(&seed, -40, 40), test_random(&seed, -40, 40)};
        assert_ok(conus_pose_toward(&pose, at, (double[]){0, 0, 0}, NULL));
        assert_ok(i % 2 ? conus_select_ball(&selection, selector, at, test_random(&seed, 1, 40))
                        : conus_select(&selection, selector, &pose, degrees_from_radians(test_random(&seed, 0.1, 2))));
        assert_ok(conus_report_create(&report, selector, NULL));
        assert_ok(conus_report_add(report, "q", selection));
        buffer_text(&wanted, voxel_header);
        count += put_all_points(&wanted, atlas, &selection->region);
        check_voxels(report, &wanted);
        conus_report_destroy(report);
        conus_selection_destroy(selection);
    }
    assert_true(count > 5000);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* The atlas without bundles has no points, and n/a in the columns of the other atlas. */
static void one_of_two_atlases_has_bundles(void **state)
{
    (void)state;
    conus_atlas *atlases[2] = {NULL, points_atlas()};
    assert_ok(atlas_create_empty(&atlases[0], "bare"));
    for (int first = 0; first < 2; first++) {
        conus_report *reports[2] = {0};
        struct buffer wanted = {0};
        const char *text = NULL;
        size_t size = 0;
        for (int i = 0; i < 2; i++) {
            bool has_bundles = i != first;
            assert_ok(add_tube(&reports[i], atlases[has_bundles], CONUS_LAYERS_ALL, has_bundles ? "lines" : "bare"));
        }
        assert_ok(conus_report_join(reports[0], reports[1]));
        buffer_format(&wanted, "query\tatlas%s", voxel_header + strlen("query"));
        put_tube(&wanted, "q1\tlines\tboth", "q1\tlines\tsecond", true);
        check_voxels(reports[0], &wanted);
        assert_ok(conus_report_text(&text, &size, reports[0]));
        assert_has(text, "\tstreamlines\tstreamlines_total\tlength_mm\tnear_x\tnear_y\tnear_z\talong\tcontact_value\n");
        const char *bare = strstr(text, "q1\tbare\tunassigned\t");
        const char *other = strstr(text, "q1\tlines\tbundle\t1\tboth\t");
        assert_true(bare && other && (bare < other) == (first == 0));
        static const char none[] = "\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\n";
        assert_int_equal(strncmp(strchr(bare, '\n') + 1 - strlen(none), none, strlen(none)), 0);
        conus_report_destroy(reports[0]);
        conus_report_destroy(reports[1]);
    }
    conus_atlas_destroy(atlases[0]);
    conus_atlas_destroy(atlases[1]);
}

static conus_status attempt(void *data)
{
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = add_tube(&report, data, CONUS_LAYERS_ALL, NULL);
    status = status ? status : conus_report_voxels(&text, &size, report);
    conus_report_destroy(report);
    return status;
}

static void every_allocation(void **state)
{
    (void)state;
    conus_atlas *atlas = points_atlas();
    test_every_allocation(attempt, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(report_bundles)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_have_columns_for_bundles),
        cmocka_unit_test(json_has_them),
        cmocka_unit_test(people_read_them),
        cmocka_unit_test(without_bundles_nothing_changes),
        cmocka_unit_test(points_of_lines_in_a_cylinder),
        cmocka_unit_test(points_of_walks_as_by_a_loop),
        cmocka_unit_test(one_of_two_atlases_has_bundles),
        cmocka_unit_test(every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
