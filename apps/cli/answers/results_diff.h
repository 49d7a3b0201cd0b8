/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How two results differ. */
#ifndef CONUS_CLI_ANSWERS_RESULTS_DIFF_H
#define CONUS_CLI_ANSWERS_RESULTS_DIFF_H

#include "cli/answers/results_reader.h"

#include <stdio.h>

/** A cell, row or column by which two tables differ. */
struct difference {
    const char *what;   /**< "changed" (a cell), "removed" or "added" (a row), "column". */
    size_t line;        /**< From 1, in the first table; of an added row in the second. */
    const char *where;  /**< "query 1: area 3 Core"; of a column "the first" or "the second", which alone has it. */
    const char *column; /**< NULL of a row. */
    const char *before, *after; /**< The cell; else NULL. */
};
typedef void difference_taker(void *user, const struct difference *difference);

struct differences {
    size_t same, changed, removed, added; /**< Rows. */
    size_t columns;                       /**< That are in one of them only. */
};

/** Compares two tables, whose rows belong together by their keys, and calls @p take for each difference. */
void tables_compare(struct differences *out, const struct results *a, const struct results *b, double tolerance,
                    difference_taker *take, void *user);

/** Writes how two pictures differ, in a line. Gives EXIT_DONE for the same picture, EXIT_DIFFERENT for another, and
 * prints an error for all other codes. */
int pictures_compare(FILE *out, const char *a, const char *b, double tolerance);

#endif
