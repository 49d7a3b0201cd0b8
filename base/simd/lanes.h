/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Numbers and truths side by side: LANES singles, which the including file defines, or half as many doubles. Arithmetic
 * is the compiler's vector extension; here and in lanes_numbers.h is what that lacks or does badly: truths (mask
 * registers on AVX-512) and choice. */
#ifndef CONUS_BASE_LANES_H
#define CONUS_BASE_LANES_H

#include <stdbool.h>
#include <stdint.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define INLINE inline __attribute__((always_inline))
#define HALF (LANES / 2)
#define EACH_AXIS _Pragma("GCC unroll 3")

typedef double doubles __attribute__((vector_size(LANES * 4), aligned(8), may_alias)); /* HALF of them */
typedef int64_t longs __attribute__((vector_size(LANES * 4), aligned(8), may_alias));
typedef float singles __attribute__((vector_size(LANES * 4), aligned(4), may_alias));
typedef int32_t wholes __attribute__((vector_size(LANES * 4), aligned(4), may_alias));

static INLINE doubles all_doubles(double x)
{
    return x - (doubles){0};
}

static INLINE singles all(float x)
{
    return x - (singles){0};
}

static INLINE wholes all_wholes(int32_t x)
{
    return x - (wholes){0};
}

/* 0, 1, 2 ... */
static INLINE wholes lane_numbers(void)
{
    wholes out;
    for (int l = 0; l < LANES; l++) {
        out[l] = l;
    }
    return out;
}

static INLINE doubles doubles_at(const double *from)
{
    return *(const doubles *)from;
}

static INLINE singles singles_at(const float *from)
{
    return *(const singles *)from;
}

static INLINE wholes wholes_at(const int32_t *from)
{
    return *(const wholes *)from;
}

static INLINE void store_doubles(double *to, doubles x)
{
    *(doubles *)to = x;
}

static INLINE void store_singles(float *to, singles x)
{
    *(singles *)to = x;
}

static INLINE void store_wholes(int32_t *to, wholes x)
{
    *(wholes *)to = x;
}

static INLINE void store_longs(uint64_t *to, longs x)
{
    *(longs *)to = x;
}

#if defined(__AVX512DQ__) && LANES == 16

typedef __mmask16 truths; /* bit l is lane l's */
typedef __mmask8 halves;  /* of doubles        */

static INLINE truths less(singles a, singles b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}

static INLINE truths at_most(singles a, singles b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LE_OQ);
}

static INLINE truths equal(singles a, singles b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_EQ_OQ);
}

static INLINE truths is_zero(wholes a)
{
    return _mm512_testn_epi32_mask((__m512i)a, (__m512i)a);
}

static INLINE truths is_positive(wholes a)
{
    return _mm512_cmpgt_epi32_mask((__m512i)a, _mm512_setzero_si512());
}

static INLINE singles choose(truths which, singles yes, singles no)
{
    return (singles)_mm512_mask_blend_ps(which, (__m512)no, (__m512)yes);
}

static INLINE halves less_doubles(doubles a, doubles b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
}

static INLINE halves at_most_doubles(doubles a, doubles b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LE_OQ);
}

static INLINE doubles choose_doubles(halves which, doubles yes, doubles no)
{
    return (doubles)_mm512_mask_blend_pd(which, (__m512d)no, (__m512d)yes);
}

static INLINE truths none(void)
{
    return 0;
}

static INLINE truths every(void)
{
    return 0xffff;
}

static INLINE bool any(truths which)
{
    return which != 0;
}

static INLINE unsigned bits_of(truths which)
{
    return which;
}

static INLINE truths both_truths(truths a, truths b)
{
    return a & b;
}

static INLINE bool all_halves(halves which)
{
    return which == 0xff;
}

static INLINE bool is_true(truths which, int lane)
{
    return which >> lane & 1;
}

static INLINE truths only(int lane)
{
    return (truths)(1U << lane);
}

static INLINE halves half_of(truths which, int half)
{
    return (halves)(which >> half * HALF);
}

#else

typedef wholes truths; /* all bits of lane l, or none */
typedef longs halves;

static INLINE truths less(singles a, singles b)
{
    return (truths)(a < b);
}

static INLINE truths at_most(singles a, singles b)
{
    return (truths)(a <= b);
}

static INLINE truths equal(singles a, singles b)
{
    return (truths)(a == b);
}

static INLINE truths is_zero(wholes a)
{
    return (truths)(a == 0);
}

static INLINE truths is_positive(wholes a)
{
    return (truths)(a > 0);
}

static INLINE singles choose(truths which, singles yes, singles no)
{
#if defined(__AVX__) && LANES == 8
    return (singles)_mm256_blendv_ps((__m256)no, (__m256)yes, (__m256)which);
#else
    return (singles)(((wholes)yes & which) | ((wholes)no & ~which));
#endif
}

static INLINE halves less_doubles(doubles a, doubles b)
{
    return (halves)(a < b);
}

static INLINE halves at_most_doubles(doubles a, doubles b)
{
    return (halves)(a <= b);
}

static INLINE doubles choose_doubles(halves which, doubles yes, doubles no)
{
    return (doubles)(((longs)yes & which) | ((longs)no & ~which));
}

static INLINE truths none(void)
{
    return (truths){0};
}

static INLINE truths every(void)
{
    return (truths){0} - 1;
}

/* Bit l is lane l's. */
static INLINE unsigned bits_of(truths which)
{
#if defined(__AVX__) && LANES == 8
    return (unsigned)_mm256_movemask_ps((__m256)which);
#elif defined(__SSE2__) && LANES == 4
    return (unsigned)_mm_movemask_ps((__m128)which);
#else
    unsigned bits = 0;
    for (int l = 0; l < LANES; l++) {
        bits |= (which[l] ? 1U : 0U) << l;
    }
    return bits;
#endif
}

static INLINE bool any(truths which)
{
    return bits_of(which) != 0;
}

static INLINE truths both_truths(truths a, truths b)
{
    return a & b;
}

static INLINE bool all_halves(halves which)
{
#if defined(__AVX__) && LANES == 8
    return _mm256_movemask_pd((__m256d)which) == 15;
#elif defined(__SSE2__) && LANES == 4
    return _mm_movemask_pd((__m128d)which) == 3;
#else
    int64_t bits = -1;
    for (int l = 0; l < HALF; l++) {
        bits &= which[l];
    }
    return bits != 0;
#endif
}

static INLINE bool is_true(truths which, int lane)
{
    return which[lane] != 0;
}

static INLINE truths only(int lane)
{
    truths out = {0};
    out[lane] = -1;
    return out;
}

static INLINE halves half_of(truths which, int half)
{
    halves out;
    for (int l = 0; l < HALF; l++) {
        out[l] = which[half * HALF + l];
    }
    return out;
}

#endif

static INLINE wholes choose_wholes(truths which, wholes yes, wholes no)
{
    return (wholes)choose(which, (singles)yes, (singles)no);
}

static INLINE longs choose_longs(halves which, longs yes, longs no)
{
    return (longs)choose_doubles(which, (doubles)yes, (doubles)no);
}

#endif
