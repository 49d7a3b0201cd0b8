/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Lists of what there is, as tables: each row is a struct that begins with a struct table_object. */
#ifndef CONUS_SELECTION_LISTS_LISTS_H
#define CONUS_SELECTION_LISTS_LISTS_H

#include "selection/table/table.h"

/** The fields of an array. */
#define LIST_FIELDS(array)                                                                                             \
    {                                                                                                                  \
        array, sizeof(array) / sizeof *(array)                                                                         \
    }

/** Makes a table of @p rows [count], which are ended; NULL is a failed allocation. @p fields is static. Positions are
 * in the world. @p atlas is NULL where rows are about none. */
conus_status list_of_rows(conus_table **out, const conus_atlas *atlas, const struct table_fields *fields, void *rows,
                          size_t size, size_t count);

#endif
