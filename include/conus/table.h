/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file table.h
 * Answers of studies: rows in typed columns. A table never changes, has copies of all names and outlives what it was
 * made of.
 */
#ifndef CONUS_PUBLIC_TABLE_H
#define CONUS_PUBLIC_TABLE_H

#include <conus/status.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_table conus_table; /**< Rows in typed columns. */

/** What the cells of a column are. */
typedef enum conus_type {
    CONUS_TYPE_NUMBER = 1, /**< A double. n/a is NaN, without an end is INFINITY; files have n/a for both. */
    CONUS_TYPE_COUNT,      /**< An int64_t: counts, labels, ranks. */
    CONUS_TYPE_TEXT        /**< UTF-8. */
} conus_type;

/** A column. Its arrays live as long as the table; those of other types are NULL. */
typedef struct conus_column {
    const char *name;         /**< "distance_mm": as in files. */
    const char *unit;         /**< "mm", "degree"; "" = none. */
    const char *help;         /**< What it is, one line. */
    conus_type type;          /**< Which of the arrays it has. */
    const double *numbers;    /**< [rows] */
    const int64_t *counts;    /**< [rows] 0 where it is n/a. */
    const char *const *texts; /**< [rows] NULL where it is n/a. */
    const uint32_t *codes;    /**< [rows] Of texts: index into words. */
    const char *const *words; /**< [word_count] Each text once; the first is NULL, which is n/a. */
    size_t word_count;        /**< How many words. */
    const bool *missing;      /**< [rows] Of counts: where it is n/a; NULL = nowhere. */
} conus_column;

/** Ends a table.
 * @param table NULL is allowed. */
CONUS_API void conus_table_destroy(conus_table *table);

/** Counts the rows.
 * @param table NULL counts 0.
 * @return How many rows there are. */
CONUS_API size_t conus_table_rows(const conus_table *table);

/** Gives a column by its place.
 * @param table The table; NULL has none.
 * @param index From 0; a loop over all columns ends at NULL.
 * @return NULL past the last. Borrowed from the table. */
CONUS_API const conus_column *conus_table_column(const conus_table *table, size_t index);

/** Gives a column by its name.
 * @param table The table; NULL has none.
 * @param name "angle_deg".
 * @return NULL where there is none of this name. Borrowed from the table. */
CONUS_API const conus_column *conus_table_find(const conus_table *table, const char *name);

/** Gives the numbers of a column.
 * @param table The table; NULL has none.
 * @param column Its name.
 * @return [rows]; NULL unless it is a column of numbers. Borrowed from the table. */
CONUS_API const double *conus_table_numbers(const conus_table *table, const char *column);

/** Gives the counts of a column.
 * @param table The table; NULL has none.
 * @param column Its name.
 * @return [rows]; NULL unless it is a column of counts. Borrowed from the table. */
CONUS_API const int64_t *conus_table_counts(const conus_table *table, const char *column);

/** Gives the texts of a column.
 * @param table The table; NULL has none.
 * @param column Its name.
 * @return [rows], each NULL where it is n/a; NULL unless it is a column of texts. Borrowed from the table. */
CONUS_API const char *const *conus_table_texts(const conus_table *table, const char *column);

/** Gives the objects that rows are about.
 * @param table The table; NULL has none.
 * @return [rows] Numbers in the atlas that was asked, as they are reported (level); 0 = none. Borrowed from the table.
 */
CONUS_API const uint32_t *conus_table_objects(const conus_table *table);

/** Gives a part of an answer that is a table of its own; the study says which it has.
 * @param table The table; NULL has none.
 * @param part Its name: "pairs".
 * @return NULL where there is none of this name. Borrowed from the table: it is not destroyed. */
CONUS_API const conus_table *conus_table_part(const conus_table *table, const char *part);

#ifdef __cplusplus
}
#endif

#endif
