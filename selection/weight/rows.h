/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Small tables of named columns. */
#ifndef CONUS_SELECTION_WEIGHT_ROWS_H
#define CONUS_SELECTION_WEIGHT_ROWS_H

#include "poses/rows/named_cells.h"

/** Takes a row of a table. */
typedef void rows_take(struct job *job, const struct named_cells *cells, void *user);

/** Reads a file of at most 64 MiB: a header with some of @p count column names, and no others, and rows. */
conus_status rows_read(const char *path, const char *const *names, size_t count, rows_take *take, void *user);

#endif
