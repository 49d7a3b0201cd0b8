/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How many poses of a batch have no answer, by its rows. */
#ifndef CONUS_BATCH_BATCH_ERRORS_H
#define CONUS_BATCH_BATCH_ERRORS_H

#include <stdbool.h>
#include <stdint.h>

/** Counts their rows, one for each atlas, in the file at @p path, in any format that can be a shard; false, after an
 * error message, when it cannot be read. */
bool batch_errors_count(uint64_t *errors, const char *path);

#endif
