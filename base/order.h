/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Three-way comparisons, below 0, 0 or above 0, and sorted lists of numbers. */
#ifndef CONUS_BASE_ORDER_H
#define CONUS_BASE_ORDER_H

#include <stddef.h>
#include <stdint.h>

static inline int compare_unsigned(uint64_t a, uint64_t b)
{
    return (a > b) - (a < b);
}

/** NaN is equal to everything. */
static inline int compare_double(double a, double b)
{
    return (a > b) - (a < b);
}

/** For qsort() and bsearch() of uint32_t or uint64_t. */
int compare_u32(const void *a, const void *b);
int compare_u64(const void *a, const void *b);

/** Sorts @p numbers and keeps each once. Returns how many are left. */
size_t u32_sort_unique(uint32_t *numbers, size_t count);

#endif
