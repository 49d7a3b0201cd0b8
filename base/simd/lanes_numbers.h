/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * What the compiler's vector extension lacks for the numbers of lanes.h, or does badly: minimum, roots, rounding, bytes
 * from anywhere, single from double. */
#ifndef CONUS_BASE_LANES_NUMBERS_H
#define CONUS_BASE_LANES_NUMBERS_H

#include "base/simd/lanes.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

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

/* The square root, of what is not negative. */
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

/* To a whole number, the nearest for |x| < 2^22; farther away one that is as far. */
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

/* Of whole numbers. */
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

/* Writes those of `which` side by side, and anything behind them: LANES numbers in all. Gives how many they are. */
static INLINE size_t keep_singles(float *out, truths which, singles x)
{
#if defined(__AVX512F__) && LANES == 16
    _mm512_storeu_ps(out, _mm512_maskz_compress_ps(which, (__m512)x));
    return (size_t)__builtin_popcount(which);
#elif defined(__AVX__) && LANES == 8
    static const int32_t order[16][4] = {
        /* of four, those of which a bit is set come first */
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
