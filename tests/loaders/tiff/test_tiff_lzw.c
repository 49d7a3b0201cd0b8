/* SPDX-License-Identifier: BSD-3-Clause */
/* LZW of long strings; short and damaged ones are in test_tiff.c. */
#include "loaders/tiff/tiff.h"

#include "base/memory.h"
#include "test.h"

#include <string.h>

/* Appends code n of a row of zeros: 256 clears the table, 0 is the first byte, and then each code is the one that the
 * reader is about to add, one byte longer than the last: n bytes. When it is read, the codes below 256 + n are taken;
 * TIFF 6.0 widens codes when 511, 1023 and 2047 are. */
static void append_code(uint8_t *packed, size_t *bit, unsigned n, bool end)
{
    unsigned code = end ? 257 : n == 0 ? 256 : n == 1 ? 0 : 256 + n;
    unsigned taken = 256 + n;
    unsigned width = taken < 511 ? 9 : taken < 1023 ? 10 : taken < 2047 ? 11 : 12;
    for (unsigned i = 0; i < width; i++, ++*bit) {
        packed[*bit / 8] |= (uint8_t)((code >> (width - 1 - i) & 1) << (7 - *bit % 8));
    }
}

static bool unpack_zeros(uint8_t *out, size_t size, unsigned codes)
{
    uint8_t *packed = memory_zeroed(codes + 2, 2);
    struct tiff_lzw *lzw = memory_raw(1, sizeof *lzw);
    size_t bit = 0;
    for (unsigned n = 0; n <= codes; n++) {
        append_code(packed, &bit, n, false);
    }
    append_code(packed, &bit, codes + 1, true);
    bool done = tiff_lzw_unpack(out, size, packed, (bit + 7) / 8, lzw);
    memory_free(lzw);
    memory_free(packed);
    return done;
}

static void lzw_codes_widen_until_the_table_is_full(void **state)
{
    (void)state;
    enum { MOST = 1 << 24 };
    uint8_t *out = memory_raw(MOST, 1);
    const unsigned codes[] = {254, 255, 300, 766, 767, 1790, 1791, 3800};
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        size_t size = (size_t)codes[i] * (codes[i] + 1) / 2; /* 1 + 2 + ... + codes */
        memset(out, 1, size + 1);
        assert_true(unpack_zeros(out, size, codes[i]));
        assert_int_equal(out[0] + out[size / 2] + out[size - 1], 0);
        assert_int_equal(out[size], 1);
        assert_false(unpack_zeros(out, size - 1, codes[i]));
        assert_false(unpack_zeros(out, size + 1, codes[i]));
    }
    assert_false(unpack_zeros(out, MOST, 5000)); /* the table has no room for 4096 + n codes */
    memory_free(out);
}

TEST_GROUP(tiff_lzw)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lzw_codes_widen_until_the_table_is_full),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
