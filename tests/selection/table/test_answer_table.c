/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of rows that are made here: what each type of column gives, what is n/a, and that nothing of what they were
 * made of is needed afterwards. */
#include "selection/table/table.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/report.h"
#include "conus/study.h"
#include "scene.h"
#include "tables.h"

#include <string.h>

struct row {
    struct table_object object;
    uint32_t rank;
    uint64_t voxels;
    double number, angle, point[3];
    const char *word;
};

static struct cell twice(const struct table_source *source, const void *row, size_t index)
{
    (void)source;
    return number_cell(2 * ((const struct row *)row)->number + (double)index);
}

static const struct table_field fields[] = {
    TABLE_IDENTITY,
    {"place", NULL, "its place", TABLE_COUNT_BY(table_place)},
    {"rank", NULL, "a rank", TABLE_OF(RANK, struct row, rank)},
    {"voxels", NULL, "a count", TABLE_OF(LARGE_COUNT, struct row, voxels)},
    {"number_mm", "mm", "a number", TABLE_OF(NUMBER, struct row, number)},
    {"angle_deg", "degree", "an angle", TABLE_OF(NUMBER, struct row, angle)},
    {"x", "mm", "a point", TABLE_OF(X, struct row, point)},
    {"y", "mm", "the same", TABLE_OF(Y, struct row, point)},
    {"z", "mm", "the same", TABLE_OF(Z, struct row, point)},
    {"own_x", "mm", "only of moved atlases", TABLE_OF(OWN_X, struct row, point)},
    {"own_y", "mm", "the same", TABLE_OF(OWN_Y, struct row, point)},
    {"own_z", "mm", "the same", TABLE_OF(OWN_Z, struct row, point)},
    {"word", NULL, "a word", TABLE_OF(TEXT, struct row, word)},
    {"twice", NULL, "twice the number, and its place", TABLE_NUMBER_BY(twice)},
};
static const struct table_fields all = {fields, sizeof fields / sizeof *fields};

/* Two areas and nothing. The words are equal, in other memory, and missing. */
static const char same[] = "same";
static const struct row rows[] = {
    {{CONUS_KIND_AREA, 1}, 1, UINT64_C(1) << 40, 0.1, 1, {1, 2, 3}, "same"},
    {{CONUS_KIND_AREA, 2}, 2, 0, INFINITY, 0.5, {-1, 0, NAN}, same},
    {{CONUS_KIND_UNASSIGNED, 0}, 0, 7, NAN, NAN, {0, 0, 0}, ""},
};

static conus_status make(conus_table **out, const conus_atlas *atlas, conus_space space, size_t count)
{
    conus_frame frame;
    assert_ok(conus_frame_find(&frame, NULL, space, NULL));
    return table_create(out, &(struct table_source){atlas, &frame}, &all, &(struct table_question){.within = 3}, rows,
                        sizeof *rows, count);
}

static conus_atlas *some_atlas(void)
{
    uint64_t seed = 5;
    return scene_atlas(&seed, 10, 0);
}

static void columns_have_what_lies_there(void **state)
{
    (void)state;
    conus_atlas *atlas = some_atlas();
    conus_table *table = NULL;
    char names[2][64];
    assert_ok(make(&table, atlas, CONUS_SPACE_RAS, 3));
    for (uint32_t i = 0; i < 2; i++) {
        snprintf(names[i], sizeof names[i], "%s", conus_atlas_object(atlas, i + 1)->name);
    }
    int64_t label = conus_atlas_object(atlas, 2)->label;
    conus_atlas_destroy(atlas); /* of which the table needs nothing */
    assert_int_equal(conus_table_rows(table), 3);
    assert_null(conus_table_find(table, "own_x")); /* it was not moved */
    assert_non_null(conus_table_column(table, all.count - 4));
    assert_null(conus_table_column(table, all.count - 3));
    assert_string_equal(table_text_at(table, "kind", 1), "area");
    assert_string_equal(table_text_at(table, "kind", 2), "unassigned");
    assert_string_equal(table_text_at(table, "name", 0), names[0]);
    assert_string_equal(table_text_at(table, "name", 1), names[1]);
    assert_string_equal(table_text_at(table, "name", 2), "unassigned");
    assert_int_equal(table_count_at(table, "index", 1), label);
    assert_true(conus_table_find(table, "index")->missing[2]);
    assert_null(conus_table_find(table, "place")->missing);
    assert_int_equal(table_count_at(table, "place", 2), 3);
    assert_int_equal(table_count_at(table, "voxels", 0), INT64_C(1) << 40);
    const conus_column *rank = conus_table_find(table, "rank");
    assert_true(!rank->missing[0] && !rank->missing[1] && rank->missing[2]);
    assert_true(table_number_at(table, "number_mm", 0) == 0.1);
    assert_true(table_number_at(table, "number_mm", 1) == INFINITY); /* files have n/a for it */
    assert_true(isnan(table_number_at(table, "number_mm", 2)));
    assert_true(table_number_at(table, "twice", 0) == 0.2);
    assert_true(table_number_at(table, "angle_deg", 0) == 1);
    assert_true(table_number_at(table, "y", 0) == 2 && isnan(table_number_at(table, "z", 1)));
    const conus_column *word = conus_table_find(table, "word");
    assert_int_equal(word->word_count, 2); /* n/a and one word, however often */
    assert_null(word->words[0]);
    assert_int_equal(word->codes[0], word->codes[1]);
    assert_null(word->texts[2]);
    assert_string_equal(word->texts[1], "same");
    assert_ptr_not_equal(word->texts[1], same);
    assert_int_equal(conus_table_objects(table)[1], 2);
    assert_true(table_question(table)->within == 3);
    conus_table_destroy(table);
}

static void other_types_are_null(void **state)
{
    (void)state;
    conus_atlas *atlas = some_atlas();
    conus_table *table = NULL;
    assert_ok(make(&table, atlas, CONUS_SPACE_RAS, 3));
    assert_null(conus_table_numbers(table, "rank"));
    assert_null(conus_table_counts(table, "name"));
    assert_null(conus_table_texts(table, "twice"));
    assert_null(conus_table_numbers(table, "Twice"));
    const conus_column *column;
    for (size_t i = 0; (column = conus_table_column(table, i)); i++) {
        assert_int_equal(!column->numbers, column->type != CONUS_TYPE_NUMBER);
        assert_int_equal(!column->counts, column->type != CONUS_TYPE_COUNT);
        assert_int_equal(!column->texts || !column->codes || !column->words, column->type != CONUS_TYPE_TEXT);
        assert_non_null(column->unit);
        assert_true(column->help[0]);
    }
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

static void no_table_and_no_row_are_empty(void **state)
{
    (void)state;
    conus_atlas *atlas = some_atlas();
    conus_table *table = NULL;
    assert_int_equal(conus_table_rows(NULL), 0);
    assert_null(conus_table_column(NULL, 0));
    assert_null(conus_table_numbers(NULL, "x"));
    assert_null(conus_table_objects(NULL));
    conus_table_destroy(NULL);
    assert_ok(make(&table, atlas, CONUS_SPACE_RAS, 0));
    assert_int_equal(conus_table_rows(table), 0);
    assert_int_equal(conus_table_find(table, "word")->word_count, 1);
    assert_non_null(conus_table_numbers(table, "x"));
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

static void positions_are_in_the_frame(void **state)
{
    (void)state;
    conus_atlas *atlas = some_atlas();
    conus_table *table = NULL;
    assert_ok(make(&table, atlas, CONUS_SPACE_LPS, 2));
    assert_true(table_number_at(table, "x", 0) == -1 && table_number_at(table, "y", 0) == -2);
    assert_true(table_number_at(table, "x", 1) == 1 && !signbit(table_number_at(table, "y", 1)));
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

static void the_last_holder_ends_it(void **state)
{
    (void)state;
    conus_atlas *atlas = some_atlas();
    conus_table *table = NULL;
    assert_ok(make(&table, atlas, CONUS_SPACE_RAS, 3));
    assert_ptr_equal(table_hold(table), table);
    conus_table_destroy(table);
    assert_string_equal(table_text_at(table, "word", 0), "same"); /* the sanitizer would see it */
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

/* Tables of other rows, and of a frame that the report does not have. */
static void reports_take_their_rows_in_their_frame(void **state)
{
    (void)state;
    conus_atlas *atlas = some_atlas();
    conus_selector *selector = NULL;
    conus_report *report = NULL;
    conus_frame lps;
    conus_table *tables[3] = {NULL};
    uint64_t seed = 5;
    const conus_pose pose = scene_generic_pose(&seed, atlas);
    assert_ok(conus_frame_find(&lps, NULL, CONUS_SPACE_LPS, NULL));
    for (int i = 0; i < 2; i++) {
        assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.frame = i ? &lps : NULL}));
        assert_ok(conus_sweep(&tables[i], selector, &pose, degrees_from_radians(1)));
        if (i == 0) {
            conus_selector_destroy(selector);
        }
    }
    assert_ok(make(&tables[2], atlas, CONUS_SPACE_LPS, 3));
    const conus_report_options options = {.rows = "admissions", .format = "tsv", .frame = &lps};
    assert_ok(conus_report_create(&report, selector, &options));
    assert_fails(conus_report_add_table(report, "ras", tables[0]), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_report_add_table(report, "rows", tables[2]), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_report_add_table(report, "lps", tables[1]));
    for (int i = 0; i < 3; i++) {
        conus_table_destroy(tables[i]); /* the report holds what it took */
    }
    const char *text = NULL;
    size_t size = 0;
    assert_ok(conus_report_text(&text, &size, report));
    assert_true(strstr(text, "\nlps\t") && !strstr(text, "\nras\t") && !strstr(text, "\nrows\t"));
    conus_report_destroy(report);
    conus_frame none = lps;
    none.space = (conus_space)99;
    conus_selector *refused = NULL;
    assert_fails(conus_selector_create(&refused, atlas, &(conus_selector_options){.frame = &none}),
                 CONUS_ERROR_ARGUMENT);
    assert_null(refused);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_status make_and_end(void *data)
{
    conus_table *table = NULL;
    conus_status status = make(&table, data, CONUS_SPACE_LPS, 3);
    conus_table_destroy(table);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = some_atlas();
    test_every_allocation(make_and_end, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(answer_table)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_have_what_lies_there),
        cmocka_unit_test(other_types_are_null),
        cmocka_unit_test(no_table_and_no_row_are_empty),
        cmocka_unit_test(positions_are_in_the_frame),
        cmocka_unit_test(the_last_holder_ends_it),
        cmocka_unit_test(reports_take_their_rows_in_their_frame),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
