/* SPDX-License-Identifier: BSD-3-Clause */
/* Places taken apart: forms, prefixes of texts, and what is no place. */
#include "poses/rows/pose_row.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *text;
    enum place_form form;
    const char *name;
} forms[] = {
    {"-42,-20,50", PLACE_NUMBERS, "-42,-20,50"},
    {" (x, y, z) = (1, 2, 3) ", PLACE_NUMBERS, "(x, y, z) = (1, 2, 3)"},
    {"L 42 P 20 S 50", PLACE_NUMBERS, "L 42 P 20 S 50"},
    {"1, 2, 3", PLACE_NUMBERS, "1, 2, 3"},
    {"Hippocampus_L", PLACE_NAME, "Hippocampus_L"},
    {" left hippocampus ", PLACE_NAME, "left hippocampus"},
    {"17", PLACE_NAME, "17"},
    {"1 2 3 4", PLACE_NAME, "1 2 3 4"},
    {"centroid:17", PLACE_CENTROID, "17"},
    {"Centroid: left hippocampus", PLACE_CENTROID, "left hippocampus"},
    {"near:Precentral_L", PLACE_NEAR, "Precentral_L"},
    {"index:17", PLACE_LABEL, "17"},
    {"1020:C3", PLACE_CAP, "C3"},
    {"centroid", PLACE_NAME, "centroid"},
    {"nearby:1", PLACE_NAME, "nearby:1"},
    {"near:1,2,3", PLACE_NEAR, "1,2,3"},
    {"\xc2\xa0\x43\x33\xc2\xa0", PLACE_NAME, "C3"}, /* no-break spaces */
    {"1020:\xc2\xa0\x43\x33\xe2\x80\x89", PLACE_CAP, "C3"},
};

static void a_place_has_a_form(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        struct place_words words;
        assert_ok(place_read(&words, text_from(forms[i].text)));
        if (words.form != forms[i].form || !text_equal(words.name, forms[i].name)) {
            fail_msg("%s: %d, \"%.*s\"", forms[i].text, words.form, (int)words.name.size, words.name.data);
        }
    }
}

static void numbers_that_are_refused_say_why(void **state)
{
    (void)state;
    struct place_words words;
    assert_ok(place_read(&words, text_from("-1,250 2 3")));
    assert_int_equal(words.form, PLACE_NAME);
    assert_fails(place_fail_numbers(&words), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "\"-1,250 2 3\": \"-1,250\" has a comma before three digits: a decimal comma, "
                                         "or one of thousands? Write a dot, or no comma");
    assert_ok(place_read(&words, text_from("Hippocampus")));
    assert_null(words.numbers.why);
}

static void what_is_no_place_is_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "",          "  ",     "near:", "centroid: ", "index:", "index:x", "index:-1", "index:4294967296",
        "index:1.5", "a\x01b", "1020:"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct place_words words = {.label = 77};
        assert_fails(place_read(&words, text_from(texts[i])), CONUS_ERROR_ARGUMENT);
        assert_int_equal(words.label, 77);
    }
}

/* No byte behind it is read. */
static void every_prefix_is_read_or_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        for (size_t size = 0; size <= strlen(forms[i].text); size++) {
            struct place_words words;
            char *exact = malloc(size ? size : 1);
            assert_non_null(exact);
            memcpy(exact, forms[i].text, size);
            conus_status status = place_read(&words, (struct text){exact, size});
            assert_true(status ? status == CONUS_ERROR_ARGUMENT : words.name.size > 0);
            free(exact);
        }
    }
}

TEST_GROUP(place_words)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_place_has_a_form),
        cmocka_unit_test(numbers_that_are_refused_say_why),
        cmocka_unit_test(what_is_no_place_is_refused),
        cmocka_unit_test(every_prefix_is_read_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
