/* SPDX-License-Identifier: BSD-3-Clause */
/* Formulas of scores (Eq. 12): their values, and every kind of mistake in one. */
#include "selection/measure/score.h"
#include "test.h"

#include <math.h>
#include <string.h>

static const char *name_at(const void *names, size_t index)
{
    const char *const *list = names;
    return list[index];
}

static const char *const names[] = {"share", "centre", "a_1", NULL};
static const double values[] = {0.25, 8, -3};

static conus_status parse(struct formula *out, const char *text)
{
    return formula_parse(out, text, name_at, names);
}

static double value_of(const char *text)
{
    struct formula formula;
    assert_ok(parse(&formula, text));
    assert_string_equal(formula.text, text);
    return formula_value(&formula, values);
}

static void formulas_are_arithmetic(void **state)
{
    (void)state;
    assert_near(value_of("share"), 0.25, 0);
    assert_near(value_of("0.5*share+0.5*centre"), 4.125, 0);
    assert_near(value_of("1 + 2 * 3"), 7, 0);
    assert_near(value_of("(1 + 2) * 3"), 9, 0);
    assert_near(value_of("8 - 4 - 2"), 2, 0);
    assert_near(value_of("16 / 4 / 2"), 2, 0);
    assert_near(value_of("-centre / 2 - -a_1"), -7, 0);
    assert_near(value_of("2*-3"), -6, 0);
    assert_near(value_of("--share"), 0.25, 0);
    assert_near(value_of("-(1+2)*2"), -6, 0);
    assert_near(value_of("\t.5e1 + 1.e-1+2E+1 "), 25.1, 1e-12);
    assert_near(value_of("centre*(share-(1-2*(a_1+4)))"), 10, 0);
}

static void what_has_no_value_is_nan(void **state)
{
    (void)state;
    struct formula formula;
    assert_true(isnan(value_of("1/(share-0.25)")));
    assert_true(isnan(value_of("0*(1/(share-share))")));
    assert_true(isnan(value_of("1e308*centre")));
    assert_ok(parse(&formula, "share+0*centre"));
    assert_true(isnan(formula_value(&formula, (double[]){1, NAN, 1})));
    assert_true(isnan(formula_value(&formula, (double[]){1, INFINITY, 1})));
}

static void uses_are_known(void **state)
{
    (void)state;
    struct formula formula;
    assert_ok(parse(&formula, "2*a_1-share"));
    assert_true(formula_uses(&formula, 0));
    assert_false(formula_uses(&formula, 1));
    assert_true(formula_uses(&formula, 2));
}

static void assert_wrong(const char *text, const char *message)
{
    struct formula formula = {.count = 77};
    assert_fails(parse(&formula, text), CONUS_ERROR_ARGUMENT);
    assert_int_equal(formula.count, 77);
    if (!strstr(conus_message(), message)) {
        fail_msg("%s: said: %s; wanted: %s", text, conus_message(), message);
    }
}

static void mistakes_are_named(void **state)
{
    (void)state;
    assert_wrong("", "column 1: the formula ends, expected is a number, a name or '('");
    assert_wrong("  ", "column 3: the formula ends");
    assert_wrong("share+", "column 7: the formula ends");
    assert_wrong("(share", "column 7: the formula ends, expected is an operator or ')'");
    assert_wrong("share)", "column 6: ')', expected is an operator or the end");
    assert_wrong("2 share", "column 3: 's', expected is an operator or the end");
    assert_wrong("2share", "column 2: 's', expected is an operator");
    assert_wrong("1.2.3", "column 4: '.', expected is an operator");
    assert_wrong("+share", "column 1: '+', expected is a number, a name or '('");
    assert_wrong("share**2", "column 7: '*'");
    assert_wrong("share, centre", "column 6: ','");
    assert_wrong("share\n", "column 6: byte 0x0a");
    assert_wrong("\xc3\xa9", "column 1: byte 0xc3");
    assert_wrong(".", "column 1: '.', expected is a number");
    assert_wrong("1e999", "column 1: '1', expected is a number of at most 63 digits that a double holds");
    assert_wrong("share^2", "column 6: '^'");
}

static void unknown_names_suggest_the_closest(void **state)
{
    (void)state;
    assert_wrong("0.5*shar", "\"shar\" is unknown; did you mean share?");
    assert_wrong("center", "\"center\" is unknown; did you mean centre?");
    assert_wrong("Share", "\"Share\" is unknown; did you mean share?");
    assert_wrong("volume", "\"volume\" is unknown, allowed are share, centre, a_1");
    assert_wrong("nan", "\"nan\" is unknown");
}

static void dividing_by_nothing_is_a_mistake(void **state)
{
    (void)state;
    assert_wrong("share/0", "division by 0");
    assert_wrong("share/(2-2)", "division by 0");
    assert_wrong("1/-0", "division by 0");
    assert_wrong("1/(1/(3-3))", "division by 0");
    assert_near(value_of("share/(0-2)"), -0.125, 0);
}

static void length_and_depth_are_limited(void **state)
{
    (void)state;
    char text[FORMULA_LENGTH_LIMIT + 2];
    struct formula formula;
    memset(text, '-', sizeof text);
    text[FORMULA_LENGTH_LIMIT] = '\0';
    text[FORMULA_LENGTH_LIMIT - 1] = '1';
    assert_ok(parse(&formula, text)); /* 255 minus signs */
    assert_near(formula_value(&formula, values), -1, 0);
    text[FORMULA_LENGTH_LIMIT] = '1';
    text[FORMULA_LENGTH_LIMIT + 1] = '\0';
    assert_wrong(text, "257 bytes long, allowed are 256");
    memset(text, '(', FORMULA_DEPTH_LIMIT + 1);
    memset(text + FORMULA_DEPTH_LIMIT, ')', sizeof text - FORMULA_DEPTH_LIMIT);
    text[FORMULA_DEPTH_LIMIT] = '1';
    text[2 * FORMULA_DEPTH_LIMIT + 1] = '\0';
    assert_ok(parse(&formula, text));
    text[FORMULA_DEPTH_LIMIT] = '(';
    assert_wrong(text, "more than 16 parentheses");
}

static void every_prefix_is_read_or_refused(void **state)
{
    (void)state;
    static const char whole[] = "-(0.5*share + 1.5e-1*centre) / (a_1 - 2.) * ((share)) - .25";
    size_t read = 0;
    for (size_t size = 0; size < sizeof whole; size++) {
        char text[sizeof whole];
        struct formula formula;
        memcpy(text, whole, size);
        text[size] = '\0';
        if (!parse(&formula, text)) {
            assert_true(formula.count <= size);
            (void)formula_value(&formula, values);
            read++;
        }
    }
    assert_true(read > 5);
}

TEST_GROUP(formula)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formulas_are_arithmetic),
        cmocka_unit_test(what_has_no_value_is_nan),
        cmocka_unit_test(uses_are_known),
        cmocka_unit_test(mistakes_are_named),
        cmocka_unit_test(unknown_names_suggest_the_closest),
        cmocka_unit_test(dividing_by_nothing_is_a_mistake),
        cmocka_unit_test(length_and_depth_are_limited),
        cmocka_unit_test(every_prefix_is_read_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
