/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables on a terminal: where lines are cut, which words are bold, which lines stay whole. Columns are counted by
 * hand. */
#include "options/options.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The columns end at 4, 25 and 38, the name's with its longest name; it has letters of two bytes. */
static const char text[] = "A sentence that is longer than any table of this test, with single spaces.\n"
                           "rank  name          share    contact x\n"
                           "                  of cone           mm\n"
                           "   1  Größe           5 %         1.25\n"
                           "      (nothing)      95 %\n"
                           "the end\n";

static void assert_fits(size_t width, bool bold, const char *wanted)
{
    char *fitted = table_fit(text, width, bold, "-o FILE");
    assert_non_null(fitted);
    assert_string_equal(fitted, wanted);
    free(fitted);
}

static void columns_are_left_out_whole(void **state)
{
    (void)state;
    static const char cut[] = "A sentence that is longer than any table of this test, with single spaces.\n"
                              "rank  name          share\n"
                              "                  of cone\n"
                              "   1  Größe           5 %\n"
                              "      (nothing)      95 %\n"
                              "the end\n"
                              "1 column left out: contact x; -o FILE\n";
    assert_fits(0, false, text);
    assert_fits(38, false, text); /* as wide as the table */
    assert_fits(37, false, cut);
    assert_fits(25, false, cut);
    assert_fits(24, false, text); /* names would be cut, and ranks alone say nothing */
    assert_fits(3, false, text);
}

static void words_end_before_the_next_ones_begin(void **state)
{
    (void)state;
    /* The name begins at 0 and source at 9, kind at 18 and path at 26: the columns end at 7, 16 and 24. */
    static const char words[] = "name     source   kind    path\n"
                                "aalaaaa  mricron  volume  /usr\n";
    static const struct {
        size_t width;
        const char *wanted;
    } cases[] = {{30, words},
                 {29, "name     source   kind\naalaaaa  mricron  volume\n1 column left out: path; -\n"},
                 {24, "name     source   kind\naalaaaa  mricron  volume\n1 column left out: path; -\n"},
                 {23, "name     source\naalaaaa  mricron\n2 columns left out: kind, path; -\n"},
                 {16, "name     source\naalaaaa  mricron\n2 columns left out: kind, path; -\n"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *fitted = table_fit(words, cases[i].width, false, "-");
        assert_string_equal(fitted, cases[i].wanted);
        free(fitted);
    }
}

/* The path begins at 26 and has four letters, which are seven bytes: the table is 30 columns wide. */
static void letters_of_two_bytes_take_one_column(void **state)
{
    (void)state;
    static const char words[] = "name     source   kind    path\n"
                                "aalaaaa  mricron  volume  /öäü\n";
    char *fitted = table_fit(words, 30, false, "-");
    assert_string_equal(fitted, words);
    free(fitted);
}

static void the_header_is_bold(void **state)
{
    (void)state;
    assert_fits(30, true,
                "A sentence that is longer than any table of this test, with single spaces.\n"
                "\033[1mrank  name          share\033[0m\n"
                "                  of cone\n"
                "   1  Größe           5 %\n"
                "      (nothing)      95 %\n"
                "the end\n"
                "1 column left out: contact x; -o FILE\n");
}

static void every_prefix_is_fitted(void **state)
{
    (void)state;
    char part[sizeof text];
    for (size_t size = 0; size < sizeof text; size++) {
        memcpy(part, text, size);
        part[size] = '\0';
        for (size_t width = 0; width < 45; width++) {
            char *fitted = table_fit(part, width, width % 2, "-o FILE");
            assert_non_null(fitted);
            free(fitted);
        }
    }
}

TEST_GROUP(table_fit)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_left_out_whole), cmocka_unit_test(words_end_before_the_next_ones_begin),
        cmocka_unit_test(the_header_is_bold),         cmocka_unit_test(letters_of_two_bytes_take_one_column),
        cmocka_unit_test(every_prefix_is_fitted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
