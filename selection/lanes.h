/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Numbers and truths side by side, LANES of each, which the including file defines. Arithmetic is the compiler's vector
 * extension; here is what that lacks or does badly: truths (mask registers on AVX-512), choice, minimum, gather. */
#ifndef CONUS_SELECTION_LANES_H
#define CONUS_SELECTION_LANES_H

#include <stdbool.h>
#include <stdint.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define INLINE inline __attribute__((always_inline))

typedef double reals __attribute__((vector_size(LANES * 8), aligned(8)));
typedef int64_t wholes __attribute__((vector_size(LANES * 8), aligned(8)));

static INLINE reals all(double x)
{
    return x - (reals){0};
}

#if defined(__AVX512DQ__) && LANES == 8

typedef __mmask8 truths; /* bit l is lane l's */

static INLINE truths less(reals a, reals b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
}

static INLINE truths at_most(reals a, reals b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LE_OQ);
}

static INLINE truths equal(reals a, reals b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_EQ_OQ);
}

static INLINE reals choose(truths which, reals yes, reals no)
{
    return (reals)_mm512_mask_blend_pd(which, (__m512d)no, (__m512d)yes);
}

static INLINE bool any(truths which)
{
    return which != 0;
}

static INLINE bool is_true(truths which, int lane)
{
    return which >> lane & 1;
}

static INLINE truths without(truths which, int lane)
{
    return (truths)(which & ~(1U << lane));
}

#else

typedef wholes truths; /* all bits of lane l, or none */

static INLINE truths less(reals a, reals b)
{
    return (truths)(a < b);
}

static INLINE truths at_most(reals a, reals b)
{
    return (truths)(a <= b);
}

static INLINE truths equal(reals a, reals b)
{
    return (truths)(a == b);
}

static INLINE reals choose(truths which, reals yes, reals no)
{
    return (reals)(((wholes)yes & which) | ((wholes)no & ~which));
}

static INLINE bool any(truths which)
{
#if defined(__AVX__) && LANES == 4
    return _mm256_movemask_pd((__m256d)which) != 0;
#elif defined(__SSE2__) && LANES == 2
    return _mm_movemask_pd((__m128d)which) != 0;
#else
    int64_t bits = 0;
    for (int l = 0; l < LANES; l++) {
        bits |= which[l];
    }
    return bits != 0;
#endif
}

static INLINE bool is_true(truths which, int lane)
{
    return which[lane] != 0;
}

static INLINE truths without(truths which, int lane)
{
    which[lane] = 0;
    return which;
}

#endif

/* a < b ? a : b */
static INLINE reals smaller(reals a, reals b)
{
#if defined(__AVX512F__) && LANES == 8
    return (reals)_mm512_min_pd((__m512d)a, (__m512d)b);
#elif defined(__AVX__) && LANES == 4
    return (reals)_mm256_min_pd((__m256d)a, (__m256d)b);
#elif defined(__SSE2__) && LANES == 2
    return (reals)_mm_min_pd((__m128d)a, (__m128d)b);
#else
    return choose(less(a, b), a, b);
#endif
}

static INLINE reals magnitude(reals x)
{
    return (reals)((wholes)x & INT64_MAX);
}

/* To the nearest whole number, for |x| < 2^51. */
static INLINE reals nearest(reals x)
{
    reals big = all(0x1.8p52);
    return (x + big) - big;
}

/* The bytes at these whole numbers, as numbers; up to 7 bytes behind each may be read. */
static INLINE reals gather(const uint8_t *bytes, reals at)
{
    wholes one = (wholes)all(0x1p52); /* numbers from 2^52 to 2^53 hold their offset in the low bits */
    wholes index = (wholes)(at + 0x1p52) ^ one;
#if defined(__AVX512F__) && LANES == 8
    wholes words = (wholes)_mm512_i64gather_epi64((__m512i)index, bytes, 1) & 0xff;
#else
    wholes words;
    for (int l = 0; l < LANES; l++) {
        words[l] = bytes[index[l]];
    }
#endif
    return (reals)(words | one) - 0x1p52;
}

#endif
