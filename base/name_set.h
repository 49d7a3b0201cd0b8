/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A set of borrowed names: n of them are added and found in O(n log^2 n), whatever they are. A hash would be
 * quicker for most files, and slow for one that was made to be slow. */
#ifndef CONUS_BASE_NAME_SET_H
#define CONUS_BASE_NAME_SET_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

struct known_name {
    const char *name; /**< Borrowed. */
    size_t value;     /**< The caller's number for it. */
};

/** Begins as all 0. The items are runs, each sorted: for each bit of `count` one of so many, the longest first. */
struct name_set {
    struct known_name *items;
    size_t count, capacity;
};

void name_set_finish(struct name_set *set);

/** An entry of @p name, whose value may be changed, or NULL. Valid until the next name is added. */
struct known_name *name_set_find(const struct name_set *set, const char *name);

/** Adds a name, even if it is there already. */
conus_status name_set_add(struct name_set *set, const char *name, size_t value);

#endif
