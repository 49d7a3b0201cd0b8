/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the tables that `conus diff` reads. */
#include "cli/answers/answers.h"
#include "options/messages.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static const char good[] = "query\tkind\tindex\tname\tpixels\r\n"
                           "1\tarea\t7\tB\t16\n"
                           "1\tarea\t11\tA\t188\n"
                           "2\tunassigned\tn/a\tunassigned\t4";

static int parse(struct results *out, const char *text)
{
    return results_parse(out, "test.tsv", text, strlen(text));
}

static void rows_are_found_by_their_key(void **state)
{
    (void)state;
    struct results results;
    assert_int_equal(parse(&results, good), EXIT_DONE);
    assert_int_equal(results.rows, 3);
    assert_int_equal(results.columns, 5);
    assert_string_equal(results_cell(&results, 1, 4), "188");
    for (size_t row = 0; row < 3; row++) {
        size_t found = 99;
        assert_true(results_find(&results, &results, row, &found));
        assert_int_equal(found, row);
    }
    struct results other;
    size_t found;
    assert_int_equal(parse(&other, "index\tquery\tkind\n11\t2\tarea\n11\t1\tarea\n"), EXIT_DONE);
    assert_false(results_find(&results, &other, 0, &found));
    assert_true(results_find(&results, &other, 1, &found));
    assert_int_equal(found, 1);
    results_finish(&results);
    results_finish(&other);
}

/* The key of a row of several atlases contains the atlas; the key of a row of one atlas does not. */
static void rows_of_several_atlases_are_found_by_their_atlas(void **state)
{
    (void)state;
    struct results both, other, alone;
    size_t found = 99;
    assert_int_equal(parse(&both, "query\tatlas\tkind\tindex\n1\taal\tarea\t7\n1\tbrodmann\tarea\t7\n"), EXIT_DONE);
    assert_int_equal(parse(&other, "query\tatlas\tkind\tindex\n1\tbrodmann\tarea\t7\n1\taicha\tarea\t7\n"), EXIT_DONE);
    assert_int_equal(parse(&alone, "query\tkind\tindex\n1\tarea\t7\n"), EXIT_DONE);
    assert_true(results_find(&both, &other, 0, &found));
    assert_int_equal(found, 1);
    assert_false(results_find(&both, &other, 1, &found));
    assert_false(results_find(&both, &alone, 0, &found));
    assert_false(results_find(&alone, &both, 0, &found));
    results_finish(&both);
    results_finish(&other);
    results_finish(&alone);
}

/* Cells after RFC 4180, section 2, rules 5 to 7, and as R writes them, with quotation marks around all texts. */
static void commas_separate_where_there_is_no_tab(void **state)
{
    (void)state;
    static const char csv[] = "\"query\",kind,index,name,last\r\n"
                              "1,\"area\",7,\"a, \"\"b\"\"\",\r\n"
                              "2,area,7,\"\"\"\",\"\"\r\n";
    static const char *const cells[][5] = {
        {"query", "kind", "index", "name", "last"}, {"1", "area", "7", "a, \"b\"", ""}, {"2", "area", "7", "\"", ""}};
    struct results results;
    assert_int_equal(parse(&results, csv), EXIT_DONE);
    assert_int_equal(results.rows, 2);
    for (size_t i = 0; i < 15; i++) {
        assert_string_equal(results.cells[i], cells[i / 5][i % 5]);
    }
    results_finish(&results);
    static const char *const bad[] = {"query,kind,index\n1,area,\"1\n", "query,kind,index\n1,\"area,1\n",
                                      "query,kind,index\n1,area,1,\n", "query,kind,index\n1,\"area\"x,1\n"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(parse(&results, bad[i]), EXIT_DATA);
    }
}

static void what_is_no_result_is_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      "\n",
                                      "{\"query\": 1}\n",
                                      "query\tkind\n",
                                      "a b c\n",
                                      "query\tkind\tindex\n1\tarea\n",
                                      "query\tkind\tindex\n1\tarea\t1\tmore\n",
                                      "query\tkind\tindex\tkind\n",
                                      "query\tkind\tindex\n1\tarea\t1\n1\tarea\t1\n"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct results results = {0};
        assert_int_equal(parse(&results, bad[i]), EXIT_DATA);
        assert_null(results.bytes);
    }
    char wide[4096] = "query\tkind\tindex"; /* 1,000 columns are read, 1,001 are not */
    struct results results = {0};
    for (size_t column = 3; column < 1001; column++) {
        assert_int_equal(column == 1000 ? parse(&results, wide) : EXIT_DONE, EXIT_DONE);
        snprintf(wide + strlen(wide), 8, "\t%03x", (unsigned)column);
    }
    results_finish(&results);
    assert_int_equal(parse(&results, wide), EXIT_DATA);
}

static void every_prefix_is_survived(void **state)
{
    (void)state;
    for (size_t size = 0; size < sizeof good - 1; size++) {
        struct results results;
        char *exact = test_malloc(size + 1);
        memcpy(exact, good, size);
        if (results_parse(&results, "test.tsv", exact, size) == EXIT_DONE) {
            assert_true(results.rows <= 3);
            results_finish(&results);
        }
        test_free(exact);
    }
}

static conus_status attempt(void *data)
{
    struct results results;
    if (parse(&results, data)) {
        return CONUS_ERROR_MEMORY;
    }
    results_finish(&results);
    return CONUS_OK;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    test_every_allocation(attempt, (void *)good);
}

static int silence(void **state)
{
    (void)state;
    return freopen("/dev/null", "w", stderr) ? 0 : -1;
}

TEST_GROUP(results_reader)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_found_by_their_key),
        cmocka_unit_test(rows_of_several_atlases_are_found_by_their_atlas),
        cmocka_unit_test(commas_separate_where_there_is_no_tab),
        cmocka_unit_test(what_is_no_result_is_refused),
        cmocka_unit_test(every_prefix_is_survived),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
