/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists of numbers in order. */
#include "base/order.h"

#include <stdlib.h>

int compare_u32(const void *a, const void *b)
{
    return compare_unsigned(*(const uint32_t *)a, *(const uint32_t *)b);
}

int compare_u64(const void *a, const void *b)
{
    return compare_unsigned(*(const uint64_t *)a, *(const uint64_t *)b);
}

size_t u32_sort_unique(uint32_t *numbers, size_t count)
{
    size_t kept = 0;
    qsort(numbers, count, sizeof *numbers, compare_u32);
    for (size_t i = 0; i < count; i++) {
        if (!kept || numbers[kept - 1] != numbers[i]) {
            numbers[kept++] = numbers[i];
        }
    }
    return kept;
}
