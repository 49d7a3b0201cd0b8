/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Three-way comparisons, below 0, 0 or above 0, the one way to sort, and that to find a row by its name. */
#ifndef CONUS_BASE_ORDER_H
#define CONUS_BASE_ORDER_H

#include "base/text.h"

static inline int compare_unsigned(uint64_t a, uint64_t b)
{
    return (a > b) - (a < b);
}

/** NaN is equal to everything. */
static inline int compare_double(double a, double b)
{
    return (a > b) - (a < b);
}

/** Compares two rows, as for bsearch(); the other knows the @p user of order_sort_by(), too. */
typedef int order_compare(const void *a, const void *b);
typedef int order_compare_by(const void *a, const void *b, void *user);

/** Of rows that are a uint32_t, a uint64_t, a double, or a pointer to text. */
order_compare compare_u32, compare_u64, compare_f64, compare_text_pointers;

/** Sorts @p count rows of @p size bytes, which may lie anywhere that malloc() would put them. It never fails. Rows that
 * are equal keep their order, on every platform and without memory, too: then it takes O(n log(n)^2), in place. */
void order_sort(void *rows, size_t count, size_t size, order_compare *compare);
void order_sort_by(void *rows, size_t count, size_t size, order_compare_by *compare, void *user);

/** The row of a table whose first member, a text with names between '/', has @p name; NULL where none has. @p exact:
 * upper and lower case differ. */
#define ROW_NAMED(rows, name, exact) row_named(rows, sizeof(rows) / sizeof *(rows), sizeof *(rows), name, exact)
static inline const void *row_named(const void *rows, size_t count, size_t size, struct text name, bool exact)
{
    for (const char *row = rows; count--; row += size) {
        const char *names;
        memcpy(&names, row, sizeof names);
        if (text_is_one_of(name, names, exact)) {
            return row;
        }
    }
    return NULL;
}

/** Sorts @p numbers and keeps each once. Returns how many are left. */
size_t u32_sort_unique(uint32_t *numbers, size_t count);

#endif
