/* SPDX-License-Identifier: BSD-3-Clause */
/* Decimal numbers as float, rounded once. */
#include "base/text.h"
#include "test.h"

/* 1 + 2^-24 is the middle between 1 and the next float, 1 + 2^-23. A number that lies above it by less than a double
 * can tell is rounded up, although the nearest double is the middle, which is rounded down. 2^-150 =
 * 0.70064923216240853546186...e-45 is the middle between 0 and the smallest float. */
static void floats_are_rounded_once(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        float wanted;
    } cases[] = {{"1.000000059604644775390625", 1},
                 {"1.00000005960464477539062500000001", 0x1.000002p0F},
                 {"-1.00000005960464477539062500000001", -0x1.000002p0F},
                 {"1.00000005960464477539062499999999", 1},
                 {"0.1", 0.1F},
                 {"1.4e-45", 0x1p-149F},
                 {"0.7006492321624085354618e-45", 0},
                 {"0.7006492321624085354619e-45", 0x1p-149F},
                 {"0", 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        float number;
        assert_true(text_to_float(text_from(cases[i].text), &number));
        assert_memory_equal(&number, &cases[i].wanted, sizeof number);
    }
}

static void what_is_no_number_is_no_float(void **state)
{
    (void)state;
    static const char *const none[] = {"", "1,5", "0x1p0", "1.0f", " 1"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        float number = 7;
        assert_false(text_to_float(text_from(none[i]), &number));
        assert_true(number == 7);
    }
}

TEST_GROUP(text_float)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_are_rounded_once),
        cmocka_unit_test(what_is_no_number_is_no_float),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
