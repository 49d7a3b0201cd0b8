/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The processor's instruction sets, for kernels that come in several (base/simd/lanes.h). */
#ifndef CONUS_BASE_PROCESSOR_H
#define CONUS_BASE_PROCESSOR_H

#include <stdbool.h>

#if defined(__x86_64__)
static inline bool processor_has_avx512(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
}

static inline bool processor_has_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
#endif

#endif
