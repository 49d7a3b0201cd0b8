/* SPDX-License-Identifier: BSD-3-Clause */
/* The processor's instruction sets: by the bits of Intel's manual, and this machine's as Linux and GCC see them. */
#include "base/simd/processor.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

enum { BOTH = PROCESSOR_AVX2 | PROCESSOR_AVX512 };

/* Leaf 1: 12 FMA, 27 OSXSAVE, 28 AVX. Leaf 7: 5 AVX2, 16 AVX512F, 17 DQ, 30 BW, 31 VL. XCR0: 1 XMM, 2 YMM, 5 to 7 the
 * mask registers and the upper parts of ZMM. */
static void a_set_needs_its_bits_and_its_registers(void **state)
{
    (void)state;
    static const unsigned all[3] = {0x18001000, 0xc0030020, 0xe6};
    static const struct {
        unsigned lacks[3], sets;
    } rows[] = {
        {{0}, BOTH},
        {{1U << 12, 0, 0}, 0},
        {{1U << 27, 0, 0}, 0},
        {{1U << 28, 0, 0}, 0},
        {{0, 1U << 5, 0}, 0},
        {{0, 1U << 16, 0}, PROCESSOR_AVX2},
        {{0, 1U << 17, 0}, PROCESSOR_AVX2},
        {{0, 1U << 30, 0}, PROCESSOR_AVX2},
        {{0, 1U << 31, 0}, PROCESSOR_AVX2},
        {{0, 0, 1U << 1}, 0},
        {{0, 0, 1U << 2}, 0},
        {{0, 0, 1U << 5}, PROCESSOR_AVX2},
        {{0, 0, 1U << 6}, PROCESSOR_AVX2},
        {{0, 0, 1U << 7}, PROCESSOR_AVX2},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const unsigned *lacks = rows[i].lacks;
        assert_int_equal(processor_sets(all[0] & ~lacks[0], all[1] & ~lacks[1], all[2] & ~lacks[2]), rows[i].sets);
        assert_int_equal(processor_sets(~lacks[0], ~lacks[1], ~lacks[2]), rows[i].sets); /* others do not matter */
    }
    assert_int_equal(processor_sets(0, 0, 0), 0);
}

static bool has_flags(const char *flags, const char *const *names)
{
    bool has = true;
    for (; *names; names++) {
        const char *at = strstr(flags, *names);
        has = has && at && strchr(" \n", at[strlen(*names)]);
    }
    return has;
}

/* Linux hides the flags of registers that it does not save. */
static void this_machine_has_what_linux_says(void **state)
{
    (void)state;
    char flags[8192] = "";
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && strncmp(flags, "flags", 5) != 0 && fgets(flags, sizeof flags, file)) {
    }
    if (file) {
        fclose(file);
    }
    if (strncmp(flags, "flags", 5) != 0) { /* of x86 */
        print_message("skipped: /proc/cpuinfo has no flags\n");
        skip();
    }
    assert_int_equal(processor_has_avx2(), has_flags(flags, (const char *[]){" avx2", " fma", NULL}));
    assert_int_equal(processor_has_avx512(), has_flags(flags, (const char *[]){" avx512f", " avx512dq", " avx512bw",
                                                                               " avx512vl", " fma", NULL}));
#if defined(__x86_64__) && defined(__GNUC__)
    assert_int_equal(processor_has_avx2(), __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"));
    assert_int_equal(processor_has_avx512(), __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                                                 __builtin_cpu_supports("avx512vl") &&
                                                 __builtin_cpu_supports("avx512bw"));
#endif
}

TEST_GROUP(processor)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_set_needs_its_bits_and_its_registers),
        cmocka_unit_test(this_machine_has_what_linux_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
