/* SPDX-License-Identifier: BSD-3-Clause */
/* The tangent, to the last bit, against values of 113 bits (GCC's libquadmath, tanq) rounded to double. */
#include "base/geometry/math3.h"
#include "test.h"

#include <math.h>

/* Halves of 0.1, 11.7, 20, 70.1, 86.1, 90, 144, 159.2, 172.1 and 179.999 degrees. Of 11.7, 70.1, 86.1, 144, 159.2 and
 * 172.1 the C library of Debian 12 has another last bit. */
static void has_the_bits_of_more_digits(void **state)
{
    (void)state;
    static const double values[][2] = {
        {0x1.c987103b761f5p-11, 0x1.c98717d802106p-11}, {0x1.a23574d659f89p-4, 0x1.a3ab0b6da9a1cp-4},
        {0x1.657184ae74487p-3, 0x1.691e1ebc5cbbcp-3},   {0x1.3935b5dcb49cep-1, 0x1.672c2b426dcf2p-1},
        {0x1.80b2d065ff11dp-1, 0x1.de48a36105918p-1},   {0x1.921fb54442d18p-1, 0x1.fffffffffffffp-1},
        {0x1.41b2f769cf0ep+0, 0x1.89f188bdcd7adp+1},    {0x1.63a7fd9e38d25p+0, 0x1.5cb56541580f8p+2},
        {0x1.80799f83f7a31p+0, 0x1.cf6ec82ba60f9p+3},   {0x1.921f22db99c8bp+0, 0x1.bf9f8f1c04f94p+16},
    };
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        assert_true(tangent(values[i][0]) == values[i][1]);
    }
    assert_true(tangent(0) == 0);
}

static void is_within_a_bit_of_the_library(void **state)
{
    (void)state;
    for (int i = 1; i < 15707; i++) {
        double theirs = tan(i * 1e-4);
        double ours = tangent(i * 1e-4);
        assert_true(ours == theirs || ours == nextafter(theirs, 0) || ours == nextafter(theirs, INFINITY));
    }
}

TEST_GROUP(tangent)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(has_the_bits_of_more_digits),
        cmocka_unit_test(is_within_a_bit_of_the_library),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
