/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The processor's instruction sets, for kernels that come in several (base/simd/lanes.h). */
#ifndef CONUS_BASE_PROCESSOR_H
#define CONUS_BASE_PROCESSOR_H

#include <stdbool.h>

/** AVX2 with FMA; AVX-512 with F, DQ, BW and VL. False on other processors than x86-64. */
bool processor_has_avx2(void);
bool processor_has_avx512(void);

enum { PROCESSOR_AVX2 = 1, PROCESSOR_AVX512 = 2 };

/** Which of the two a processor has by @p leaf_1, ECX of cpuid's leaf 1, and @p leaf_7, EBX of its leaf 7, on a system
 * that saves the registers of @p xcr0. Without its registers a set is none: they would change under a kernel. */
unsigned processor_sets(unsigned leaf_1, unsigned leaf_7, unsigned xcr0);

#endif
