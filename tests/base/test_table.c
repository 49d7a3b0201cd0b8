/* SPDX-License-Identifier: BSD-3-Clause */
/* Separators, cells and numbers of delimited text. */
#include "base/formats/table.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

static struct table decide(const char *text)
{
    struct table table = {0};
    table_decide(&table, text_from(text));
    return table;
}

/* The same two rows as every program separates them; what is between them is not counted. */
static void separators_are_found(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum table_separator separator;
        size_t cells, first;
    } cases[] = {
        {"a\t1\t2\t3\nb\t4\t5\t6\n", TABLE_TABS, 4, 1},
        {"name;x;y;z\na;1;2;3\nb;4;5;6\n", TABLE_SEMICOLONS, 4, 2},
        {"name;x;y;z\na;-1,5;2,25;3\nb;4,0;5;6\n", TABLE_SEMICOLONS, 4, 2},
        {"name,x,y,z\nM1 hand,1,2,3\nb c d,4,5,6\n", TABLE_COMMAS, 4, 2},
        {"1, 2, 3\n4, 5, 6\n", TABLE_COMMAS, 3, 1},
        {"| name | x | y | z |\n|---|---|---|---|\n| a | 1 | 2 | 3 |\n", TABLE_PIPES, 4, 3},
        {"left hand   1   2   3\nfoot        4  -5   6\n", TABLE_BLANKS, 4, 1},
        {"1 2 3\n4 5 6\n7  8  9\n", TABLE_SPACES, 3, 1},
        {"-42,5 12,0 30,1\n", TABLE_SPACES, 3, 1},
        {"-42,5; 12; 30\n", TABLE_SEMICOLONS, 3, 1},
        {"-42,5, 12, 30\n", TABLE_COMMAS, 4, 1},
        {"12,5,30\n", TABLE_COMMAS, 3, 1},
        {"# 1 2 3\n% 1;2;3\n// 1,2,3\nPeaks, of 3 subjects, 4 runs, 5 days\n1;2;3\n1;2;3", TABLE_SEMICOLONS, 3, 5},
        {"sep=,\n1;2;3,4,5,6\n", TABLE_COMMAS, 4, 2},
        {"a 1,2,3\nb 4,5,6\n", TABLE_COMMAS, 0, 0},
        {"name,x,y,z\n", TABLE_TABS, 0, 0},
        {"", TABLE_TABS, 0, 0},
        {"\n\n;;;\n---\t---\n", TABLE_TABS, 0, 0},
        {"1;2;3\n1;2;3;4\n1;2;3;4\n", TABLE_SEMICOLONS, 4, 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct table table = decide(cases[i].text);
        if (table.cells != cases[i].cells || table.first != cases[i].first ||
            (table.cells && table.separator != cases[i].separator)) {
            fail_msg("case %zu: separator %d, %zu cells, first %zu", i, (int)table.separator, table.cells, table.first);
        }
    }
}

/* A comma before three digits says nothing by itself; another number does, and two that contradict each other undo it.
 */
static void commas_are_what_the_table_shows(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum table_comma comma;
        const char *cell;
        double value; /* NaN: none */
    } cases[] = {
        {"1;2;3\n", TABLE_COMMA_UNKNOWN, "1,5", NAN},
        {"1,5;2;3\n", TABLE_COMMA_DECIMAL, "1,250", 1.25},
        {"-1,250;2;3\n", TABLE_COMMA_UNCLEAR, "-1,250", NAN},
        {"-1,250;2,75;3\n", TABLE_COMMA_DECIMAL, "-1,250", -1.25},
        {"-1,250;2,500,000;3\n", TABLE_COMMA_THOUSANDS, "-1,250", -1250},
        {"-1,250;2,500.5;3\n", TABLE_COMMA_THOUSANDS, "2,500.5", 2500.5},
        {"0,250;2;3\n", TABLE_COMMA_DECIMAL, "0,250", 0.25},
        {"1234,567;2;3\n", TABLE_COMMA_DECIMAL, "1234,567", 1234.567},
        {"1,5;2,500,000;3\n", TABLE_COMMA_UNCLEAR, "1,5", NAN},
        {"a,\"1,5\",\"2,5\",\"3,5\"\n", TABLE_COMMA_DECIMAL, "-1,5e1", -15},
        {"1,5;2;3\n", TABLE_COMMA_DECIMAL, "1,5,2", NAN},
        {"1,5;2;3\n", TABLE_COMMA_DECIMAL, "1,", NAN},
        {"1,5;2;3\n", TABLE_COMMA_DECIMAL, ",5", 0.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct table table = decide(cases[i].text);
        double value = NAN;
        bool found = table_number(&value, &table, text_from(cases[i].cell));
        if (table.comma != cases[i].comma || found == isnan(cases[i].value) || (found && value != cases[i].value)) {
            fail_msg("case %zu: comma %d, %g", i, (int)table.comma, value);
        }
    }
}

static void numbers_are_typeset(void **state)
{
    (void)state;
    static const char *const good[] = {"\xe2\x88\x92"
                                       "1.5",
                                       "\xe2\x80\x93"
                                       "1.5",
                                       "\xe2\x80\x91"
                                       "1.5",
                                       "\xc2\xad"
                                       "1.5",
                                       "-1.5\xc2\xa0",
                                       "\xe2\x80\x89-1.5",
                                       "\xe2\x80\xaf\xe2\x88\x92"
                                       "1.5 "};
    static const char *const bad[] = {"\xe2\x88\x92",
                                      "\xe2\x88\x92\xe2\x88\x92"
                                      "1",
                                      "\xe2\x88\x92 1",
                                      "1\xe2\x88\x92",
                                      "\xe2\x80\x94"
                                      "1",
                                      "1.5 mm",
                                      "",
                                      "\xc2\xa0"};
    const struct table table = {0};
    double value;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_true(table_number(&value, &table, text_from(good[i])));
        assert_true(value == -1.5);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(table_number(&value, &table, text_from(bad[i])));
    }
}

static void check_cells(enum table_separator separator, const char *text, const char *wanted)
{
    const struct table table = {.separator = separator};
    struct table_line line;
    char got[256] = "";
    assert_true(table_split(&line, &table, text_from(text)));
    for (size_t i = 0; i < line.count; i++) {
        snprintf(got + strlen(got), sizeof got - strlen(got), "[%.*s]", TEXT_SHOW(line.cells[i], 40));
    }
    assert_string_equal(got, wanted);
}

static void cells_are_split(void **state)
{
    (void)state;
    check_cells(TABLE_COMMAS, "a, b ,\"c,d\",,", "[a][b][c,d][][]");
    check_cells(TABLE_TABS, "A'1\t5\" left\t\"q\"\"r\"", "[A'1][5\" left][q\"\"r]");
    check_cells(TABLE_PIPES, " | a | b | |", "[a][b][]");
    check_cells(TABLE_PIPES, "a|b", "[a][b]");
    check_cells(TABLE_BLANKS, "  left hand   1\t2  \t 3 4  ", "[left hand][1][2][3 4]");
    check_cells(TABLE_SPACES, " \"left hand\" 1\t 2 ", "[left hand][1][2]");
    check_cells(TABLE_SPACES, "", "");
    check_cells(TABLE_SEMICOLONS, "\xc2\xa0 a \xc2\xa0;b", "[a][b]");
    struct table_line line;
    const struct table commas = {.separator = TABLE_COMMAS};
    assert_true(table_split(&line, &commas, text_from("a,b,,")) && line.count == 4 && line.given == 2);
    assert_true(table_split(&line, &commas, text_from("a,\"b")) && line.spoilt.data && line.is_unclosed);
    assert_true(table_split(&line, &commas, text_from("a,b\"c")) && line.spoilt.data && !line.is_unclosed);
    char many[2 * TABLE_CELLS + 2];
    memset(many, ',', sizeof many);
    assert_true(table_split(&line, &commas, (struct text){many, TABLE_CELLS - 1}) && line.count == TABLE_CELLS);
    assert_false(table_split(&line, &commas, (struct text){many, TABLE_CELLS}));
}

static void lines_without_data(void **state)
{
    (void)state;
    static const char *const blank[] = {"", " \t", ",,;", "|---|:--:|", "-----  ----", "=====", "sep=;", "SEP=,"};
    static const char *const comments[] = {"# a", " % a", "//a", "## a"};
    struct text inside;
    for (size_t i = 0; i < sizeof blank / sizeof blank[0]; i++) {
        assert_true(table_is_blank(text_from(blank[i])));
        assert_false(table_is_comment(&inside, text_from(blank[i])));
    }
    for (size_t i = 0; i < sizeof comments / sizeof comments[0]; i++) {
        assert_true(table_is_comment(&inside, text_from(comments[i])));
        assert_true(text_equal(inside, "a"));
    }
    assert_false(table_is_blank(text_from("- 1")) || table_is_comment(&inside, text_from("/a")));
    assert_true(text_equal(inside, "/a"));
}

/* Whatever part of a table there is, nothing beyond it is read. */
static void every_prefix_is_decided(void **state)
{
    (void)state;
    static const char text[] = "Peaks of 3 runs\n# name;x;y;z\n\"a;b\";\xe2\x88\x92"
                               "1,5;\"2,5\";3,25\xc2\xa0;\n|---|\nsep=;\nb;1,250;2;3\n";
    for (size_t size = 0; size < sizeof text; size++) {
        char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
        memcpy(exact, text, size);
        struct table table = {0};
        struct table_line line;
        table_decide(&table, (struct text){exact, size});
        assert_true(table_split(&line, &table, (struct text){exact, size}));
        assert_true(table.cells == 0 || (table.separator == TABLE_SEMICOLONS && table.first == 3));
        free(exact);
    }
}

TEST_GROUP(table)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(separators_are_found), cmocka_unit_test(commas_are_what_the_table_shows),
        cmocka_unit_test(numbers_are_typeset),  cmocka_unit_test(cells_are_split),
        cmocka_unit_test(lines_without_data),   cmocka_unit_test(every_prefix_is_decided),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
