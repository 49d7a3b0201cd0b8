/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 20: the areas that bundles connect, for lines from area to area whose counts and lengths are known. */
#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "scene.h"
#include "tables.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <string.h>

/* Cells of 1 mm along x from 0: areas 1 to 3 in cells 0, 10 and 20. */
enum { LENGTH = 21, LINES = 8, POINTS = 14 };
static const float corners[3 * POINTS] = {
    0, 0, 0, 10, 0, 0,                    /* 0: from 1 to 2, 10 mm      */
    10, 0, 0, 0, 0, 0,                    /* 1: back, 10 mm             */
    10, 0, 0, 10, 6, 0, 0, 6, 0, 0, 0, 0, /* 2: from 2 to 1, 22 mm, a detour */
    20, 0, 0, 10, 0, 0,                   /* 3: from 3 to 2, 10 mm      */
    0, 0, 0,                              /* 4: one point, in 1         */
                                          /* 5: none                    */
    12, 0, 0, 20, 0, 0,                   /* 6: 1.5 mm from 2, to 3     */
    5, 0, 0,                              /* 7: one point far from all  */
};
static const uint64_t first[LINES + 1] = {0, 2, 4, 8, 10, 11, 11, 13, 14};

static struct tractogram all_lines(void)
{
    return tract_of("lines.tck", corners, first, LINES, 0.5);
}

static conus_atlas *three_areas(void)
{
    uint32_t labels[LENGTH] = {[0] = 1, [10] = 2, [20] = 3};
    const conus_volume_info grid = scene_plain_grid((const size_t[]){LENGTH, 1, 1}, NULL);
    return scene_parcellation(&grid, labels);
}

static conus_atlas *with_lines(void)
{
    conus_atlas *atlas = three_areas();
    struct tractogram lines = all_lines();
    assert_ok(atlas_add_tractogram(atlas, &lines, "lines"));
    return atlas;
}

static conus_table *connect(const conus_atlas *atlas, double radius, const char *level)
{
    conus_selector *selector = NULL;
    conus_table *table = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.level = level}));
    assert_ok(conus_connectivity(&table, selector, NULL, radius, true));
    conus_selector_destroy(selector);
    return table;
}

static const conus_table *pairs_of(const conus_table *table)
{
    assert_non_null(conus_table_part(table, "pairs"));
    return conus_table_part(table, "pairs");
}

static const conus_table *areas_of(const conus_table *table)
{
    assert_non_null(conus_table_part(table, "areas"));
    return conus_table_part(table, "areas");
}

/* Bundle and areas by number, which is an area's label in these scenes; 0 = none. */
struct connection {
    uint32_t bundle, area_a, area_b;
    uint64_t streamlines;
    double fraction, length;
};

static struct connection connection_at(const conus_table *table, size_t row)
{
    return (struct connection){.bundle = conus_table_objects(table)[row],
                               .area_a = (uint32_t)table_count_at(table, "end_a_index", row),
                               .area_b = (uint32_t)table_count_at(table, "end_b_index", row),
                               .streamlines = (uint64_t)table_count_at(table, "streamlines", row),
                               .fraction = table_number_at(table, "fraction", row),
                               .length = table_number_at(table, "mean_length_mm", row)};
}

static struct connection pair_at(const conus_table *table, size_t row)
{
    const conus_table *pairs = pairs_of(table);
    const uint32_t *areas = conus_table_objects(areas_of(table));
    return (struct connection){.bundle = conus_table_objects(pairs)[row],
                               .area_a = areas[table_count_at(pairs, "area_a", row)],
                               .area_b = areas[table_count_at(pairs, "area_b", row)],
                               .streamlines = (uint64_t)table_count_at(pairs, "streamlines", row),
                               .fraction = table_number_at(pairs, "fraction", row),
                               .length = table_number_at(pairs, "mean_length_mm", row)};
}

static void check_same(struct connection got, struct connection wanted)
{
    assert_int_equal(got.bundle, wanted.bundle);
    assert_int_equal(got.area_a, wanted.area_a);
    assert_int_equal(got.area_b, wanted.area_b);
    assert_int_equal(got.streamlines, wanted.streamlines);
    assert_near(got.fraction, wanted.fraction, 1e-15);
    assert_near(got.length, wanted.length, 1e-12);
}

static void check(const conus_table *table, size_t row, struct connection wanted)
{
    check_same(connection_at(table, row), wanted);
}

/* The pair of two rows of the areas; as many as there are pairs if nothing connects them. */
static size_t pair_between(const conus_table *table, size_t a, size_t b)
{
    const conus_table *pairs = pairs_of(table);
    size_t row = 0;
    for (; row < conus_table_rows(pairs); row++) {
        size_t x = (size_t)table_count_at(pairs, "area_a", row);
        size_t y = (size_t)table_count_at(pairs, "area_b", row);
        if ((x == a && y == b) || (x == b && y == a)) {
            break;
        }
    }
    return row;
}

static uint64_t streamlines_between(const conus_table *table, size_t a, size_t b)
{
    const conus_table *pairs = pairs_of(table);
    size_t row = pair_between(table, a, b);
    return row < conus_table_rows(pairs) ? pair_at(table, row).streamlines : 0;
}

/* Bundle 4 with a radius below 0: only the cell at an end counts, and streamline 6 has one end in no area, the other
 * one in 3. */
static void test_lines_between_areas_in_closed_form(void **state)
{
    (void)state;
    conus_atlas *atlas = with_lines();
    conus_table *table = connect(atlas, -1, NULL);
    assert_int_equal(conus_table_rows(table), 5);
    check(table, 0, (struct connection){4, 1, 2, 3, 3 / 8.0, 14});
    check(table, 1, (struct connection){4, 0, 0, 2, 2 / 8.0, 0});
    check(table, 2, (struct connection){4, 1, 1, 1, 1 / 8.0, 0});
    check(table, 3, (struct connection){4, 2, 3, 1, 1 / 8.0, 10});
    check(table, 4, (struct connection){4, 3, 0, 1, 1 / 8.0, 8});
    assert_null(conus_table_part(table, "pair"));
    assert_null(conus_table_part(NULL, "pairs"));
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

/* The default of 2 mm, and 1.5 mm, reach from x = 12 to the cell that ends at 10.5; 1.4 mm do not. */
static void test_an_end_near_an_area_has_it(void **state)
{
    (void)state;
    static const double reach[] = {0, 1.5, 1.4};
    conus_atlas *atlas = with_lines();
    for (size_t i = 0; i < 3; i++) {
        conus_table *table = connect(atlas, reach[i], NULL);
        assert_int_equal(conus_table_rows(table), i < 2 ? 4 : 5);
        if (i < 2) {
            check(table, 1, (struct connection){4, 2, 3, 2, 2 / 8.0, 9});
        }
        conus_table_destroy(table);
    }
    conus_atlas_destroy(atlas);
}

/* Streamline 0 is in both groups, 3 in the second, all others are the rest. */
static conus_atlas *with_groups(void)
{
    static const uint32_t one[] = {0};
    static const uint32_t two[] = {0, 3};
    conus_atlas *atlas = three_areas();
    struct tractogram lines = all_lines();
    tract_add_group(&lines, "one", one, 1);
    tract_add_group(&lines, "two", two, 2);
    assert_ok(atlas_add_tractogram(atlas, &lines, "rest"));
    return atlas;
}

/* Bundles 4 to 6 have 1, 2 and 6 streamlines; together they are 8, since one is in two of them. */
static void test_a_streamline_of_two_bundles_is_one_in_pairs(void **state)
{
    (void)state;
    conus_atlas *atlas = with_groups();
    conus_table *table = connect(atlas, -1, NULL);
    uint64_t streamlines[7] = {0};
    double fractions[7] = {0};
    for (size_t i = 0; i < conus_table_rows(table); i++) {
        struct connection row = connection_at(table, i);
        streamlines[row.bundle] += row.streamlines;
        fractions[row.bundle] += row.fraction;
    }
    for (size_t i = 0; i < conus_table_rows(pairs_of(table)); i++) {
        struct connection pair = pair_at(table, i);
        assert_int_equal(pair.bundle, 0);
        streamlines[0] += pair.streamlines;
        fractions[0] += pair.fraction;
    }
    assert_true(streamlines[4] == 1 && streamlines[5] == 2 && streamlines[6] == 6 && streamlines[0] == LINES);
    for (size_t bundle = 0; bundle < 7; bundle++) {
        assert_near(fractions[bundle], streamlines[bundle] ? 1 : 0, 1e-15);
    }
    check_same(pair_at(table, 0), (struct connection){0, 1, 2, 3, 3 / 8.0, 14});
    assert_int_equal(conus_table_rows(pairs_of(table)), 5);
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

/* Lines from cell to cell along x, more than one thread counts: cell 0 is area 1, cell 10 area 2, cell 20 area 3, and
 * all others have none. */
enum { MANY = 20000 };

static uint32_t area_of_cell(uint64_t cell)
{
    return cell % 10 ? 0 : (uint32_t)(1 + cell / 10);
}

struct counted {
    uint64_t streamlines;
    double length;
};

/* Every second line is in the first group, every third in the second one, the others are the rest. */
static bool is_member(size_t bundle, uint64_t line)
{
    bool is[3] = {line % 2 == 0, line % 3 == 0, line % 2 && line % 3};
    return bundle == 0 || is[bundle - 1];
}

static void count_pair(struct counted counted[4][4], const uint64_t cells[2])
{
    uint32_t a = area_of_cell(cells[0]);
    uint32_t b = area_of_cell(cells[1]);
    uint32_t low = a - 1 < b - 1 ? a : b; /* none is last */
    struct counted *pair = &counted[low][low == a ? b : a];
    pair->streamlines++;
    pair->length += fabs((double)cells[0] - (double)cells[1]);
}

static void test_many_streamlines_are_counted_as_one_by_one(void **state)
{
    (void)state;
    static float points[6 * MANY];
    static uint64_t begins[MANY + 1];
    static uint32_t members[2][MANY];
    struct counted counted[4][4][4] = {0}; /* of all, and of the three bundles */
    size_t counts[2] = {0};
    size_t pair_counts[4] = {0};
    uint64_t random = 40;
    for (size_t line = 0; line < MANY; line++) {
        uint64_t cells[2];
        for (size_t i = 0; i < 2; i++) {
            cells[i] = (uint64_t)test_random(&random, 0, LENGTH);
            points[6 * line + 3 * i] = (float)cells[i];
        }
        begins[line + 1] = 2 * line + 2;
        for (size_t bundle = 0; bundle < 4; bundle++) {
            if (is_member(bundle, line)) {
                count_pair(counted[bundle], cells);
            }
        }
        for (size_t group = 0; group < 2; group++) {
            if (is_member(group + 1, line)) {
                members[group][counts[group]++] = (uint32_t)line;
            }
        }
    }
    conus_atlas *atlas = three_areas();
    struct tractogram lines = tract_of("lines.tck", points, begins, MANY, 0.5);
    tract_add_group(&lines, "two", members[0], counts[0]);
    tract_add_group(&lines, "three", members[1], counts[1]);
    assert_ok(atlas_add_tractogram(atlas, &lines, "rest"));
    conus_table *table = connect(atlas, -1, NULL);
    size_t rows = conus_table_rows(table);
    size_t pairs = conus_table_rows(pairs_of(table));
    for (size_t i = 0; i < rows + pairs; i++) {
        struct connection row = i < rows ? connection_at(table, i) : pair_at(table, i - rows);
        size_t bundle = i < rows ? row.bundle - 3 : 0;
        const struct counted *wanted = &counted[bundle][row.area_a][row.area_b];
        assert_int_equal(row.streamlines, wanted->streamlines);
        assert_near(row.length, wanted->length / (double)wanted->streamlines, 1e-12);
        pair_counts[bundle]++;
    }
    for (size_t bundle = 0; bundle < 4; bundle++) {
        assert_int_equal(pair_counts[bundle], 10); /* of 4 ends, none included */
    }
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

static void test_the_matrix_is_symmetric_with_none_last(void **state)
{
    (void)state;
    static const uint32_t areas[] = {1, 2, 3, 0};
    static const uint64_t streamlines[4][4] = {{1, 3, 0, 0}, {3, 0, 1, 0}, {0, 1, 0, 1}, {0, 0, 1, 2}};
    static const double length[4][4] = {{0, 14, NAN, NAN}, {14, NAN, 10, NAN}, {NAN, 10, NAN, 8}, {NAN, NAN, 8, 0}};
    conus_atlas *atlas = with_groups();
    conus_table *table = connect(atlas, -1, NULL);
    assert_int_equal(conus_table_rows(areas_of(table)), 4);
    for (size_t i = 0; i < 16; i++) {
        size_t row = pair_between(table, i / 4, i % 4);
        assert_int_equal(conus_table_objects(areas_of(table))[i / 4], areas[i / 4]);
        assert_int_equal(streamlines_between(table, i / 4, i % 4), streamlines[i / 4][i % 4]);
        assert_true(isnan(length[i / 4][i % 4]) ? row == conus_table_rows(pairs_of(table))
                                                : pair_at(table, row).length == length[i / 4][i % 4]);
    }
    assert_string_equal(table_text_at(areas_of(table), "name", 3), "unassigned");
    assert_true(conus_table_find(areas_of(table), "index")->missing[3]);
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

/* Area 1 becomes a part of 2. Ends near 1 are then near 2: 5 mm reach from x = 5 to the cell that ends at 0.5. */
static void test_a_level_joins_areas(void **state)
{
    (void)state;
    conus_atlas *atlas = with_lines();
    atlas->objects[0].parent = 2;
    conus_table *table = connect(atlas, 5, "1");
    assert_int_equal(conus_table_rows(table), 3);
    check(table, 0, (struct connection){4, 2, 2, 5, 5 / 8.0, 42 / 5.0});
    check(table, 1, (struct connection){4, 2, 3, 2, 2 / 8.0, 9});
    check(table, 2, (struct connection){4, 0, 0, 1, 1 / 8.0, 0});
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

/* The text of a report on all streamlines, and on those of a ball around (12, 5, 0), which are none. */
static char *report_of(const conus_atlas *atlas, const char *format)
{
    conus_selector *selector = NULL;
    conus_selection *nothing = NULL;
    conus_table *tables[2] = {NULL, NULL};
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    const conus_report_options options = {.rows = "connections", .format = format};
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select_ball(&nothing, selector, (const double[]){12, 5, 0}, 1));
    assert_ok(conus_connectivity(&tables[0], selector, NULL, 0, true));
    assert_ok(conus_connectivity(&tables[1], selector, nothing, 0, true));
    assert_ok(conus_report_create(&report, selector, &options));
    assert_ok(conus_report_add_table(report, "all", tables[0]));
    assert_ok(conus_report_add_table(report, "ball", tables[1]));
    assert_ok(conus_report_add_error(report, "bad", 7, "no pose"));
    assert_fails(conus_report_add(report, "ball", nothing), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_report_text(&text, &size, report));
    char *copy = memory_text(text, size);
    assert_non_null(copy);
    conus_report_destroy(report);
    conus_table_destroy(tables[0]);
    conus_table_destroy(tables[1]);
    conus_selection_destroy(nothing);
    conus_selector_destroy(selector);
    return copy;
}

static void test_a_report_has_a_row_for_each_connection(void **state)
{
    (void)state;
    conus_atlas *atlas = with_lines();
    char *text = report_of(atlas, "tsv");
    assert_string_equal(text, "query\tkind\tbundle\tend_a\tend_b\tstreamlines\tfraction\tmean_length_mm\tbundle_index\t"
                              "end_a_index\tend_b_index\n"
                              "all\tbundle\tlines\t1\t2\t3\t0.375\t14\t1\t1\t2\n"
                              "all\tbundle\tlines\t2\t3\t2\t0.25\t9\t1\t2\t3\n"
                              "all\tbundle\tlines\tunassigned\tunassigned\t2\t0.25\t0\t1\tn/a\tn/a\n"
                              "all\tbundle\tlines\t1\t1\t1\t0.125\t0\t1\t1\t1\n"
                              "bad\terror\tline 7: no pose\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\n");
    memory_free(text);
    text = report_of(atlas, "json");
    assert_non_null(strstr(text, "\"endpoint_radius_mm\": 2.0"));
    assert_non_null(strstr(text, "\"radius_mm\": 1.0")); /* of the ball */
    memory_free(text);
    text = report_of(atlas, "table");
    assert_non_null(strstr(text, "all streamlines\nends in an area, or in the nearest one within 2 mm\n"));
    assert_non_null(strstr(text, "lines   (in no area)  (in no area)            2      25.00          0.0\n"));
    assert_non_null(strstr(text, "(12.00, 5.00, 0.00), RAS mm\nends in an area, or in the nearest one within 2 mm\n"
                                 "(no streamline)\n"));
    memory_free(text);
    conus_atlas_destroy(atlas);
}

static void test_hidden_areas_and_bundles_are_not_there(void **state)
{
    (void)state;
    conus_atlas *atlas = with_groups();
    assert_ok(conus_atlas_show(atlas, NULL, "2,two,rest"));
    conus_table *table = connect(atlas, -1, NULL);
    assert_int_equal(conus_table_rows(table), 1);
    check(table, 0, (struct connection){4, 1, 0, 1, 1, 10});
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

static void test_without_bundles_there_is_nothing(void **state)
{
    (void)state;
    conus_atlas *atlas = three_areas();
    conus_table *table = connect(atlas, 0, NULL);
    assert_int_equal(conus_table_rows(table), 0);
    assert_int_equal(conus_table_rows(pairs_of(table)), 0);
    assert_int_equal(conus_table_rows(areas_of(table)), 4); /* the size of the matrix does not depend on streamlines */
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

/* The areas of the matrix after conus_atlas_show(only, hide), 0 last; and what connects the first two. */
static void check_areas(conus_atlas *atlas, const char *only, const char *hide, const char *level,
                        const uint32_t *wanted, size_t count, uint64_t first_pair)
{
    assert_ok(conus_atlas_show(atlas, only, hide));
    conus_table *table = connect(atlas, -1, level);
    const conus_table *areas = areas_of(table);
    assert_int_equal(conus_table_rows(areas), count + 1);
    assert_memory_equal(conus_table_objects(areas), wanted, count * sizeof *wanted);
    assert_int_equal(conus_table_objects(areas)[count], 0);
    assert_int_equal(streamlines_between(table, 0, 1), first_pair);
    conus_table_destroy(table);
}

/* 3 streamlines connect 1 and 2, and one 2 and 3. */
static void test_the_matrix_has_the_areas_that_are_named_in_their_order(void **state)
{
    (void)state;
    conus_atlas *atlas = with_lines();
    check_areas(atlas, NULL, NULL, NULL, (const uint32_t[]){1, 2, 3}, 3, 3);
    check_areas(atlas, "3,1,2,lines,1", NULL, NULL, (const uint32_t[]){3, 1, 2}, 3, 0);
    check_areas(atlas, "2,1,lines", NULL, NULL, (const uint32_t[]){2, 1}, 2, 3);
    check_areas(atlas, "3,2,1,lines", "2", NULL, (const uint32_t[]){3, 1}, 2, 0);
    check_areas(atlas, NULL, "2", NULL, (const uint32_t[]){1, 3}, 2, 0);
    conus_atlas_destroy(atlas);
}

/* Areas 1 and 2 are parts of 4, which has no voxels of its own; 5 has none at all. */
static conus_atlas *areas_in_a_group(void)
{
    static const uint32_t labels[LENGTH] = {[0] = 1, [10] = 2, [20] = 3};
    struct label entries[] = {{.number = 1, .has_parent = true, .parent = 4},
                              {.number = 2, .has_parent = true, .parent = 4},
                              {.number = 3},
                              {.number = 4, .name = (char *)"group"},
                              {.number = 5, .name = (char *)"empty"}};
    const struct label_table table = {.entries = entries, .count = 5};
    const conus_volume_info grid = scene_plain_grid((const size_t[]){LENGTH, 1, 1}, NULL);
    struct tractogram lines = all_lines();
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create(&atlas, &grid, labels, &table, "scene", &notes));
    notes_finish(&notes);
    assert_ok(atlas_add_tractogram(atlas, &lines, "lines"));
    return atlas;
}

/* A group stands for its areas, and an area for what is nearest above it in the list. */
static void test_groups_and_empty_areas_of_the_matrix(void **state)
{
    (void)state;
    conus_atlas *atlas = areas_in_a_group();
    check_areas(atlas, NULL, NULL, NULL, (const uint32_t[]){1, 2, 3}, 3, 3);
    check_areas(atlas, "5,3,4,lines", NULL, NULL, (const uint32_t[]){5, 3, 1, 2}, 4, 0);
    check_areas(atlas, "2,4,lines", NULL, NULL, (const uint32_t[]){2, 1}, 2, 3);
    check_areas(atlas, "3,5,lines", "5", NULL, (const uint32_t[]){3}, 1, 2); /* with ends in none */
    check_areas(atlas, NULL, NULL, "1", (const uint32_t[]){3, 4}, 2, 1);
    check_areas(atlas, "4,3,lines", NULL, "1", (const uint32_t[]){4, 3}, 2, 1);
    conus_atlas_destroy(atlas);
}

/* A ball of 1 mm around (10, 5, 0) holds a part of the detour only, whose ends are far away. */
static void test_only_streamlines_in_the_region(void **state)
{
    (void)state;
    conus_atlas *atlas = with_groups();
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_table *table = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select_ball(&selection, selector, (const double[]){10, 5, 0}, 1));
    assert_ok(conus_connectivity(&table, selector, selection, 0, true));
    assert_int_equal(conus_table_rows(table), 1);
    check(table, 0, (struct connection){6, 1, 2, 1, 1, 22});
    conus_table_destroy(table);
    assert_ok(conus_connectivity(&table, selector, selection, 0, false));
    check(table, 0, (struct connection){6, 1, 2, 1, 1, 22});
    assert_null(conus_table_part(table, "pairs"));
    assert_null(conus_table_part(table, "areas"));
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    const conus_report_options options = {.rows = "connections", .format = "tsv"};
    assert_ok(conus_report_create(&report, selector, &options));
    assert_fails(conus_report_matrix(&text, &size, report, table), CONUS_ERROR_ARGUMENT);
    conus_report_destroy(report);
    conus_table_destroy(table);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* A cone from (15, 30, 0) down -y, 10 degrees wide: at y = 0 it reaches from 12.4 to 17.6. Lines 3 and 6 pass it. */
static void test_a_cone_picks_streamlines(void **state)
{
    (void)state;
    conus_atlas *atlas = with_groups();
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_table *table = NULL;
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (const double[]){15, 30, 0}, (const double[]){0, -1, 0}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 10));
    assert_ok(conus_connectivity(&table, selector, selection, 0, true));
    assert_int_equal(conus_table_rows(table), 2);
    check(table, 0, (struct connection){5, 2, 3, 1, 1, 10});
    check(table, 1, (struct connection){6, 2, 3, 1, 1, 8});
    check_same(pair_at(table, 0), (struct connection){0, 2, 3, 2, 1, 9});
    conus_table_destroy(table);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void test_a_selection_of_another_atlas_is_refused(void **state)
{
    (void)state;
    conus_atlas *atlases[2] = {three_areas(), with_lines()};
    conus_selector *selectors[2] = {NULL, NULL};
    conus_selection *selection = NULL;
    conus_table *table = NULL;
    assert_ok(conus_selector_create(&selectors[0], atlases[0], NULL));
    assert_ok(conus_selector_create(&selectors[1], atlases[1], NULL));
    assert_ok(conus_select_ball(&selection, selectors[0], (const double[]){0, 0, 0}, 1));
    assert_fails(conus_connectivity(&table, selectors[1], selection, 0, true), CONUS_ERROR_ARGUMENT);
    assert_null(table);
    conus_selection_destroy(selection);
    for (size_t i = 0; i < 2; i++) {
        conus_selector_destroy(selectors[i]);
        conus_atlas_destroy(atlases[i]);
    }
}

static void test_a_radius_has_limits(void **state)
{
    (void)state;
    static const double bad[] = {100.5, INFINITY, NAN};
    conus_atlas *atlas = with_lines();
    conus_selector *selector = NULL;
    conus_table *table = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (size_t i = 0; i < 3; i++) {
        assert_fails(conus_connectivity(&table, selector, NULL, bad[i], true), CONUS_ERROR_ARGUMENT);
        assert_null(table);
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Tables and JSON are the formats of the matrix; all others are refused. */
static void test_the_matrix_as_text(void **state)
{
    (void)state;
    conus_atlas *atlas = with_groups();
    conus_table *table = connect(atlas, -1, NULL);
    FOR_WORDS(format, "table", "tsv", "csv", "json", "ndjson")
    {
        conus_selector *selector = NULL;
        conus_report *report = NULL;
        const char *text = NULL;
        size_t size = 0;
        const conus_report_options options = {.rows = "connections", .format = format};
        assert_ok(conus_selector_create(&selector, atlas, NULL));
        assert_ok(conus_report_create(&report, selector, &options));
        if (strcmp(format, "table") == 0 || strcmp(format, "ndjson") == 0) {
            assert_fails(conus_report_matrix(&text, &size, report, table), CONUS_ERROR_ARGUMENT);
            assert_null(text);
        } else {
            assert_ok(conus_report_matrix(&text, &size, report, table));
            assert_int_equal(strlen(text), size);
        }
        if (strcmp(format, "tsv") == 0) {
            assert_string_equal(text, "area\t1\t2\t3\tunassigned\n1\t1\t3\t0\t0\n2\t3\t0\t1\t0\n3\t0\t1\t0\t1\n"
                                      "unassigned\t0\t0\t1\t2\n");
        }
        conus_report_destroy(report);
        conus_selector_destroy(selector);
    }
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

/* A row of cells of 1 mm, each an area: one more than a matrix may have. Streamlines connect areas all the same. */
static void test_a_matrix_of_too_many_areas_is_refused(void **state)
{
    (void)state;
    enum { AREAS = 8192 + 1 };
    uint32_t *labels = memory_zeroed(AREAS, sizeof *labels);
    assert_non_null(labels);
    for (uint32_t i = 0; i < AREAS; i++) {
        labels[i] = i + 1;
    }
    const conus_volume_info grid = scene_plain_grid((const size_t[]){AREAS, 1, 1}, NULL);
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    struct tractogram lines = all_lines();
    assert_ok(atlas_add_tractogram(atlas, &lines, "lines"));
    conus_table *table = connect(atlas, -1, NULL);
    conus_selector *selector = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    const conus_report_options options = {.rows = "connections", .format = "tsv"};
    assert_true(conus_table_rows(table) > 0);
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_report_create(&report, selector, &options));
    assert_fails(conus_report_matrix(&text, &size, report, table), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "a table of 8193 areas, allowed are up to 8192"));
    assert_null(text);
    conus_report_destroy(report);
    conus_selector_destroy(selector);
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
    memory_free(labels);
}

static conus_status connect_once(void *user)
{
    const conus_report_options options = {.rows = "connections", .format = "json"};
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_table *table = NULL;
    conus_status status = conus_selector_create(&selector, user, NULL);
    status = status ? status : conus_select_ball(&selection, selector, (const double[]){5, 0, 0}, 9);
    status = status ? status : conus_connectivity(&table, selector, selection, 0, true);
    status = status ? status : conus_report_create(&report, selector, &options);
    status = status ? status : conus_report_add_table(report, "1", table);
    status = status ? status : conus_report_matrix(&text, &size, report, table);
    conus_report_destroy(report);
    conus_table_destroy(table);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return status;
}

static void test_every_failing_allocation_is_reported(void **state)
{
    (void)state;
    conus_atlas *atlas = with_groups();
    test_every_allocation(connect_once, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(connectivity)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines_between_areas_in_closed_form),
        cmocka_unit_test(test_an_end_near_an_area_has_it),
        cmocka_unit_test(test_a_streamline_of_two_bundles_is_one_in_pairs),
        cmocka_unit_test(test_many_streamlines_are_counted_as_one_by_one),
        cmocka_unit_test(test_the_matrix_is_symmetric_with_none_last),
        cmocka_unit_test(test_a_level_joins_areas),
        cmocka_unit_test(test_a_report_has_a_row_for_each_connection),
        cmocka_unit_test(test_the_matrix_as_text),
        cmocka_unit_test(test_a_matrix_of_too_many_areas_is_refused),
        cmocka_unit_test(test_hidden_areas_and_bundles_are_not_there),
        cmocka_unit_test(test_without_bundles_there_is_nothing),
        cmocka_unit_test(test_the_matrix_has_the_areas_that_are_named_in_their_order),
        cmocka_unit_test(test_groups_and_empty_areas_of_the_matrix),
        cmocka_unit_test(test_only_streamlines_in_the_region),
        cmocka_unit_test(test_a_cone_picks_streamlines),
        cmocka_unit_test(test_a_selection_of_another_atlas_is_refused),
        cmocka_unit_test(test_a_radius_has_limits),
        cmocka_unit_test(test_every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
