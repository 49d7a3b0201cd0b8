/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Numbers and truths side by side: LANES singles, which the including file defines, or half as many doubles. Arithmetic
 * is the compiler's vector extension; here is what that lacks or does badly: truths (mask registers on AVX-512),
 * choice, minimum, roots, rounding, bytes from anywhere, single from double. */
#ifndef CONUS_BASE_LANES_H
#define CONUS_BASE_LANES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
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
#elif defined(__wasm_simd128__) && LANES == 4
    return wasm_i32x4_bitmask((v128_t)which);
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

/* a < b ? a : b */
static INLINE singles smaller(singles a, singles b)
{
#if defined(__AVX512F__) && LANES == 16
    return (singles)_mm512_min_ps((__m512)a, (__m512)b);
#elif defined(__AVX__) && LANES == 8
    return (singles)_mm256_min_ps((__m256)a, (__m256)b);
#elif defined(__SSE2__) && LANES == 4
    return (singles)_mm_min_ps((__m128)a, (__m128)b);
#else
    return choose(less(a, b), a, b);
#endif
}

/* a > b ? a : b */
static INLINE singles larger(singles a, singles b)
{
#if defined(__AVX512F__) && LANES == 16
    return (singles)_mm512_max_ps((__m512)a, (__m512)b);
#elif defined(__AVX__) && LANES == 8
    return (singles)_mm256_max_ps((__m256)a, (__m256)b);
#elif defined(__SSE2__) && LANES == 4
    return (singles)_mm_max_ps((__m128)a, (__m128)b);
#else
    return choose(less(b, a), a, b);
#endif
}

/* a < b ? a : b */
static INLINE doubles smaller_doubles(doubles a, doubles b)
{
#if defined(__AVX512F__) && LANES == 16
    return (doubles)_mm512_min_pd((__m512d)a, (__m512d)b);
#elif defined(__AVX__) && LANES == 8
    return (doubles)_mm256_min_pd((__m256d)a, (__m256d)b);
#else
    return choose_doubles(less_doubles(a, b), a, b);
#endif
}

/* a > b ? a : b */
static INLINE doubles larger_doubles(doubles a, doubles b)
{
#if defined(__AVX512F__) && LANES == 16
    return (doubles)_mm512_max_pd((__m512d)a, (__m512d)b);
#elif defined(__AVX__) && LANES == 8
    return (doubles)_mm256_max_pd((__m256d)a, (__m256d)b);
#else
    return choose_doubles(less_doubles(b, a), a, b);
#endif
}

/* The least of them. */
static INLINE double least_of_doubles(doubles x)
{
    double least = x[0];
    for (int l = 1; l < HALF; l++) {
        least = x[l] < least ? x[l] : least;
    }
    return least;
}

/* The square root; numbers must not be negative. */
static INLINE singles root(singles x)
{
#if defined(__AVX512F__) && LANES == 16
    return (singles)_mm512_sqrt_ps((__m512)x);
#elif defined(__AVX__) && LANES == 8
    return (singles)_mm256_sqrt_ps((__m256)x);
#elif defined(__SSE2__) && LANES == 4
    return (singles)_mm_sqrt_ps((__m128)x);
#else
    for (int l = 0; l < LANES; l++) {
        x[l] = __builtin_sqrtf(x[l]);
    }
    return x;
#endif
}

/* a b + c, rounded once or twice. */
static INLINE singles multiply_add(singles a, singles b, singles c)
{
#if defined(__AVX512F__) && LANES == 16
    return (singles)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
#elif defined(__FMA__) && LANES == 8
    return (singles)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
#else
    return a * b + c;
#endif
}

static INLINE singles magnitude(singles x)
{
    return (singles)((wholes)x & INT32_MAX);
}

static INLINE doubles magnitude_of_doubles(doubles x)
{
    return (doubles)((longs)x & INT64_MAX);
}

/* x, which is not negative, with the sign of `sign`. */
static INLINE singles with_sign(singles x, singles sign)
{
    return (singles)((wholes)x | ((wholes)sign & INT32_MIN));
}

/* Rounds to the nearest whole number for |x| < 2^22; farther away to one that is as far from 0. */
static INLINE singles nearest(singles x)
{
#if defined(__AVX512F__) && LANES == 16
    return (singles)_mm512_roundscale_ps((__m512)x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
#elif defined(__AVX__) && LANES == 8
    return (singles)_mm256_round_ps((__m256)x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
#else
    singles big = all(0x1.8p23F);
    return (x + big) - big;
#endif
}

/* For |x| < 2^51. */
static INLINE doubles nearest_doubles(doubles x)
{
    doubles big = all_doubles(0x1.8p52);
    return (x + big) - big;
}

/* For |x| < 2^51: the least whole number that is not below it, and the largest that is not above it. */
static INLINE doubles ceiling_of_doubles(doubles x)
{
    doubles whole = nearest_doubles(x);
    return choose_doubles(less_doubles(whole, x), whole + 1, whole);
}

static INLINE doubles floor_of_doubles(doubles x)
{
    doubles whole = nearest_doubles(x);
    return choose_doubles(less_doubles(x, whole), whole - 1, whole);
}

static INLINE doubles root_of_doubles(doubles x)
{
#if defined(__AVX512F__) && LANES == 16
    return (doubles)_mm512_sqrt_pd((__m512d)x);
#elif defined(__AVX__) && LANES == 8
    return (doubles)_mm256_sqrt_pd((__m256d)x);
#elif defined(__SSE2__) && LANES == 4
    return (doubles)_mm_sqrt_pd((__m128d)x);
#else
    for (int l = 0; l < HALF; l++) {
        x[l] = sqrt(x[l]);
    }
    return x;
#endif
}

/* x holds whole numbers. */
static INLINE wholes wholes_from_singles(singles x)
{
#if defined(__AVX512F__) && LANES == 16
    return (wholes)_mm512_cvtps_epi32((__m512)x);
#elif defined(__AVX__) && LANES == 8
    return (wholes)_mm256_cvtps_epi32((__m256)x);
#elif defined(__SSE2__) && LANES == 4
    return (wholes)_mm_cvtps_epi32((__m128)x);
#else
    return __builtin_convertvector(x, wholes);
#endif
}

static INLINE singles singles_from_wholes(wholes x)
{
#if defined(__AVX512F__) && LANES == 16
    return (singles)_mm512_cvtepi32_ps((__m512i)x);
#elif defined(__AVX__) && LANES == 8
    return (singles)_mm256_cvtepi32_ps((__m256i)x);
#elif defined(__SSE2__) && LANES == 4
    return (singles)_mm_cvtepi32_ps((__m128i)x);
#else
    return __builtin_convertvector(x, singles);
#endif
}

/* LANES bytes in a row. */
static INLINE wholes wholes_from_bytes(const uint8_t *bytes)
{
#if defined(__AVX2__) && LANES == 8
    return (wholes)_mm256_cvtepu8_epi32(_mm_loadu_si64(bytes));
#elif defined(__SSE2__) && LANES == 4
    __m128i pairs = _mm_unpacklo_epi8(_mm_loadu_si32(bytes), _mm_setzero_si128());
    return (wholes)_mm_unpacklo_epi16(pairs, _mm_setzero_si128());
#else
    wholes out;
    for (int l = 0; l < LANES; l++) {
        out[l] = bytes[l];
    }
    return out;
#endif
}

static INLINE singles singles_from_bytes(const uint8_t *bytes)
{
    return singles_from_wholes(wholes_from_bytes(bytes));
}

/* Side by side. */
static INLINE singles singles_from_doubles(doubles low, doubles high)
{
#if defined(__AVX512DQ__) && LANES == 16
    __m512 one = _mm512_castps256_ps512(_mm512_cvtpd_ps((__m512d)low));
    return (singles)_mm512_insertf32x8(one, _mm512_cvtpd_ps((__m512d)high), 1);
#elif defined(__AVX__) && LANES == 8
    return (singles)_mm256_set_m128(_mm256_cvtpd_ps((__m256d)high), _mm256_cvtpd_ps((__m256d)low));
#else
    singles out;
    for (int l = 0; l < HALF; l++) {
        out[l] = (float)low[l];
        out[HALF + l] = (float)high[l];
    }
    return out;
#endif
}

/* Reads HALF singles. */
static INLINE doubles load_as_doubles(const float *in)
{
#if defined(__AVX512F__) && LANES == 16
    return (doubles)_mm512_cvtps_pd(_mm256_loadu_ps(in));
#elif defined(__AVX__) && LANES == 8
    return (doubles)_mm256_cvtps_pd(_mm_loadu_ps(in));
#else
    doubles out;
    for (int l = 0; l < HALF; l++) {
        out[l] = in[l];
    }
    return out;
#endif
}

/* Writes the lanes of `which` side by side, then anything: LANES numbers in all. Gives how many are valid. */
static INLINE size_t keep_singles(float *out, truths which, singles x)
{
#if defined(__AVX512F__) && LANES == 16
    _mm512_storeu_ps(out, _mm512_maskz_compress_ps(which, (__m512)x));
    return (size_t)__builtin_popcount(which);
#elif defined(__AVX__) && LANES == 8
    static const int32_t order[16][4] = {
        /* of four lanes, those whose bit is set come first */
        {0, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {2, 0, 0, 0}, {0, 2, 0, 0}, {1, 2, 0, 0}, {0, 1, 2, 0},
        {3, 0, 0, 0}, {0, 3, 0, 0}, {1, 3, 0, 0}, {0, 1, 3, 0}, {2, 3, 0, 0}, {0, 2, 3, 0}, {1, 2, 3, 0}, {0, 1, 2, 3}};
    const unsigned bits = bits_of(which);
    const size_t low = (size_t)__builtin_popcount(bits & 15);
    const __m128i low_order = _mm_loadu_si128((const __m128i *)order[bits & 15]);
    const __m128i high_order = _mm_loadu_si128((const __m128i *)order[bits >> 4]);
    _mm_storeu_ps(out, _mm_permutevar_ps(_mm256_castps256_ps128((__m256)x), low_order));
    _mm_storeu_ps(out + low, _mm_permutevar_ps(_mm256_extractf128_ps((__m256)x, 1), high_order));
    return low + (size_t)__builtin_popcount(bits >> 4);
#else
    size_t count = 0;
    for (int l = 0; l < LANES; l++) {
        float one = x[l];
        memcpy(out + count, &one, sizeof one); /* may be a whole number's place */
        count += is_true(which, l);
    }
    return count;
#endif
}

static INLINE size_t keep_wholes(int32_t *out, truths which, wholes x)
{
    return keep_singles((float *)out, which, (singles)x);
}

/* Whole numbers from 0 to 2^52. */
static INLINE longs longs_from_doubles(doubles x)
{
    longs one = (longs)all_doubles(0x1p52); /* numbers from 2^52 to 2^53 hold their offset in the low bits */
    return (longs)(x + 0x1p52) ^ one;
}

/* HALF doubles from anywhere. */
static INLINE doubles doubles_from(const double *from, const int32_t *at)
{
#if defined(__AVX512F__) && LANES == 16
    return (doubles)_mm512_i32gather_pd(_mm256_loadu_si256((const __m256i *)at), from, 8);
#else
    doubles out;
    for (int l = 0; l < HALF; l++) {
        out[l] = from[at[l]];
    }
    return out;
#endif
}

/* The bytes at LANES offsets. */
static INLINE wholes bytes_at(const uint8_t *bytes, const int32_t *at)
{
    __asm__("" : : "m"(*(const int32_t(*)[LANES])at)); /* in memory, or they are taken out of a register one by one */
#if defined(__AVX2__) && LANES >= 8
    __m128i parts[LANES / 4];
    for (int i = 0; i < LANES / 4; i++) {
        parts[i] = _mm_cvtsi32_si128(bytes[at[4 * i]]);
        parts[i] = _mm_insert_epi8(parts[i], bytes[at[4 * i + 1]], 1);
        parts[i] = _mm_insert_epi8(parts[i], bytes[at[4 * i + 2]], 2);
        parts[i] = _mm_insert_epi8(parts[i], bytes[at[4 * i + 3]], 3);
    }
    parts[0] = _mm_unpacklo_epi32(parts[0], parts[1]);
#if LANES == 16
    parts[2] = _mm_unpacklo_epi32(parts[2], parts[3]);
    return (wholes)_mm512_cvtepu8_epi32(_mm_unpacklo_epi64(parts[0], parts[2]));
#else
    return (wholes)_mm256_cvtepu8_epi32(parts[0]);
#endif
#else
    wholes out;
    for (int l = 0; l < LANES; l++) {
        out[l] = bytes[at[l]];
    }
    return out;
#endif
}

#endif
