/* SPDX-License-Identifier: BSD-3-Clause */
/* Sine, cosine and arc tangent against values of 200 bits (mpmath) rounded to double, and against the C library's. */
#include "base/geometry/math3.h"
#include "test.h"

#include <math.h>

/* The tolerance between two doubles whose last bits may differ a little. */
static const double BITS = 6e-16;

static void sines_have_the_digits_of_more(void **state)
{
    (void)state;
    static const double values[][3] = {
        {0.1, 0x1.98eaecb8bcb2cp-4, 0x1.fd712f9a817c1p-1},
        {0.7853981633974483, 0x1.6a09e667f3bccp-1, 0x1.6a09e667f3bcdp-1},
        {1, 0x1.aed548f090ceep-1, 0x1.14a280fb5068cp-1},
        {1.5707963267948966, 1, 0x1.1a62633145c07p-54},
        {2, 0x1.d18f6ead1b446p-1, -0x1.aa22657537205p-2},
        {3.141592653589793, 0x1.1a62633145c07p-53, -1},
        {-4, 0x1.837b9dddc1eaep-1, -0x1.4eaa606db24c1p-1},
        {5.5, -0x1.693c94e0ab057p-1, 0x1.6ad6c3c07d448p-1},
        {-7.25, -0x1.a56adb62a27b9p-1, 0x1.22c6f50dc3fbep-1},
        {100, -0x1.03425b78c4db8p-1, 0x1.b981dbf665fdfp-1},
    };
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        assert_true(fabs(sine_of(values[i][0]) - values[i][1]) <= 2e-16);
        assert_true(fabs(cosine_of(values[i][0]) - values[i][2]) <= 2e-16);
    }
    assert_true(sine_of(0) == 0 && cosine_of(0) == 1);
    assert_true(isnan(sine_of(NAN)) && isnan(cosine_of(INFINITY)));
}

static void arc_tangents_have_the_digits_of_more(void **state)
{
    (void)state;
    static const double values[][3] = {
        {1, 1, 0x1.921fb54442d18p-1},    {1, 2, 0x1.dac670561bb4fp-2},
        {3, -1, 0x1.e47df3d0dd4d1p+0},   {-0.001, 5, -0x1.a36e2e53f1004p-13},
        {-2, -7, -0x1.6e8062854db5ep+1}, {1e-300, 1e-299, 0x1.983e282e2cc4cp-4},
        {5, 0, 0x1.921fb54442d18p+0},    {-1e+300, 1e+300, -0x1.921fb54442d18p-1},
        {0.06, 1, 0x1.eaee734b5dd23p-5}, {1, -1e-09, 0x1.921fb5488e548p+0},
    };
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        double angle = arc_tangent(values[i][0], values[i][1]);
        assert_true(fabs(angle - values[i][2]) <= BITS * fabs(values[i][2]));
    }
    assert_true(arc_tangent(0, 3) == 0 && arc_tangent(0, -3) == MATH3_PI && arc_tangent(0, 0) == 0);
    assert_true(isnan(arc_tangent(NAN, 1)) && isnan(arc_tangent(1, NAN)) && isnan(arc_tangent(1, INFINITY)));
}

/* All around the circle, in steps that do not divide it. */
static void are_those_of_the_library_but_for_the_last_bits(void **state)
{
    (void)state;
    for (int i = -30000; i <= 30000; i++) {
        double x = i * 3.1e-4;
        double s = sine_of(x);
        double c = cosine_of(x);
        assert_true(fabs(s - sin(x)) <= 2.5e-16 && fabs(c - cos(x)) <= 2.5e-16);
        double theirs = atan2(s, c);
        assert_true(fabs(arc_tangent(s, c) - theirs) <= BITS * fabs(theirs));
        assert_true(fabs(arc_tangent(x, 1) - atan(x)) <= BITS * fabs(atan(x)));
    }
}

TEST_GROUP(arc)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sines_have_the_digits_of_more),
        cmocka_unit_test(arc_tangents_have_the_digits_of_more),
        cmocka_unit_test(are_those_of_the_library_but_for_the_last_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
