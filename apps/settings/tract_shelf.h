/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tractograms that were read, for whoever opens the same files again: another atlas, or the same one with other
 * options. */
#ifndef CONUS_SETTINGS_TRACT_SHELF_H
#define CONUS_SETTINGS_TRACT_SHELF_H

#include "conus/own.h"

#include <stdbool.h>

/** A zeroed one is empty. */
struct tract_shelf {
    struct shelved *items; /**< [count] */
    size_t count;
};

/** Whether @p path was read, in these axes. */
bool tract_shelf_has(const struct tract_shelf *shelf, const char *path, conus_file_space space);
/** The tractogram @p path, which is read where it was not. It stays the shelf's, and what it is added to must end
 * before it. */
conus_status tract_shelf_find(const conus_tractogram **out, struct tract_shelf *shelf, const char *path,
                              const conus_streamlines_options *options);
/** Begins a load. Unless the same files are opened @p again, what was read before it is not found by it. */
void tract_shelf_begin(struct tract_shelf *shelf, bool again);
/** Ends what the last load did not find. */
void tract_shelf_drop(struct tract_shelf *shelf);
void tract_shelf_finish(struct tract_shelf *shelf);

#endif
