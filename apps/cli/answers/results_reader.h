/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A result of conus read back from its TSV or CSV file, for comparison. */
#ifndef CONUS_CLI_ANSWERS_RESULTS_READER_H
#define CONUS_CLI_ANSWERS_RESULTS_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { RESULTS_KEYS = 14 };

struct results {
    char *bytes;        /**< The text that the cells point into. */
    const char **cells; /**< The header's, then each row's, `columns` at a time. */
    size_t columns, rows;
    char separator;                  /**< Tab or comma. */
    const char **keys[RESULTS_KEYS]; /**< Header cells of query, kind and the others of results_find(); NULL = none. */
    size_t *order;                   /**< Rows, sorted by their keys. */
};

/** Reads @p path, of at most @p limit bytes. Returns the exit code and prints an error unless it is 0; @p out is then
 * the caller's to results_finish(). Two rows with one key are an error. */
int results_load(struct results *out, const char *path, uint64_t limit);
/** The same from @p size bytes at @p bytes, which are copied; @p path is for messages. */
int results_parse(struct results *out, const char *path, const char *bytes, size_t size);
void results_finish(struct results *results);

const char *results_cell(const struct results *results, size_t row, size_t column);

/** Index of the column @p name; false if there is none. */
bool results_column(const struct results *results, const char *name, size_t *column);

/** Finds the row of @p results with the key of @p row of @p other; false if there is none. The key is the query, kind
 * and index, and where a table has them the atlas, the voxel (i, j, k), a segment's order, bundle_index and the areas
 * of a connection. A row that names its atlas never matches one that does not. */
bool results_find(const struct results *results, const struct results *other, size_t row, size_t *found);

#endif
