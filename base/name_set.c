/* SPDX-License-Identifier: BSD-3-Clause */
/* Sorted runs whose lengths are powers of two: the logarithmic method of Bentley and Saxe (1980). */
#include "base/memory.h"

#include "base/order.h"

#include <stdlib.h>
#include <string.h>

static int compare_known(const void *a, const void *b)
{
    return strcmp(((const struct known_name *)a)->name, ((const struct known_name *)b)->name);
}

static size_t lowest_bit(size_t count)
{
    return count & (~count + 1);
}

void name_set_finish(struct name_set *set)
{
    memory_free(set->items);
    *set = (struct name_set){0};
}

struct known_name *name_set_find(const struct name_set *set, const char *name)
{
    const struct known_name key = {.name = name};
    struct known_name *found = NULL;
    for (size_t end = set->count; end && !found; end -= lowest_bit(end)) {
        size_t length = lowest_bit(end);
        found = bsearch(&key, set->items + end - length, length, sizeof key, compare_known);
    }
    return found;
}

conus_status name_set_add(struct name_set *set, const char *name, size_t value)
{
    if (!memory_reserve(&set->items, &set->capacity, set->count + 1, sizeof *set->items)) {
        return CONUS_ERROR_MEMORY;
    }
    set->items[set->count++] = (struct known_name){name, value};
    size_t length = lowest_bit(set->count); /* the new name, and all runs as long as those behind them */
    order_sort(set->items + set->count - length, length, sizeof *set->items, compare_known);
    return CONUS_OK;
}
