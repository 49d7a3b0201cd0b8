/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the processor itself: __builtin_cpu_supports() says no to everything in programs of zig's clang. The bits are
 * those of Intel's manual, volume 2A (CPUID) and volume 1, 13.3 and 14.3 (XCR0). */
#include "base/simd/processor.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

static bool has_all(unsigned bits, unsigned wanted)
{
    return (bits & wanted) == wanted;
}

unsigned processor_sets(unsigned leaf_1, unsigned leaf_7, unsigned xcr0)
{
    const unsigned fma_osxsave_avx = 1U << 12 | 1U << 27 | 1U << 28;
    const unsigned avx2 = 1U << 5;
    const unsigned f_dq_bw_vl = 1U << 16 | 1U << 17 | 1U << 30 | 1U << 31;
    const unsigned xmm_ymm = 1U << 1 | 1U << 2;
    const unsigned masks_zmm = 1U << 5 | 1U << 6 | 1U << 7;
    if (!has_all(leaf_1, fma_osxsave_avx) || !has_all(leaf_7, avx2) || !has_all(xcr0, xmm_ymm)) {
        return 0;
    }
    return PROCESSOR_AVX2 | (has_all(leaf_7, f_dq_bw_vl) && has_all(xcr0, masks_zmm) ? PROCESSOR_AVX512 : 0);
}

static unsigned ask_processor(void)
{
    unsigned sets = 0;
#if defined(__x86_64__)
    unsigned a, b, leaf_1, leaf_7, c, d;
    if (__get_cpuid(1, &a, &b, &leaf_1, &d) && leaf_1 & bit_OSXSAVE && __get_cpuid_count(7, 0, &a, &leaf_7, &c, &d)) {
        unsigned xcr0;
        unsigned high;
        __asm__("xgetbv" : "=a"(xcr0), "=d"(high) : "c"(0));
        sets = processor_sets(leaf_1, leaf_7, xcr0);
    }
#endif
    return sets;
}

/* Virtual machines take microseconds for each cpuid, so it is asked once. Two threads may ask at once: of one
 * processor. */
static bool has_set(unsigned set)
{
    enum { ASKED = 1 << 8 };
    static _Atomic unsigned known;
    unsigned sets = known;
    if (!sets) {
        sets = ask_processor() | ASKED;
        known = sets;
    }
    return sets & set;
}

bool processor_has_avx2(void)
{
    return has_set(PROCESSOR_AVX2);
}

bool processor_has_avx512(void)
{
    return has_set(PROCESSOR_AVX512);
}
