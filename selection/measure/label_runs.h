/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The rows of a parcellation, along whichever axis, as runs of voxels of one object each. They take a small part of its
 * labels' memory, so that more of them stays near the processor. */
#ifndef CONUS_SELECTION_MEASURE_LABEL_RUNS_H
#define CONUS_SELECTION_MEASURE_LABEL_RUNS_H

#include "atlas/volume.h"

/** A zeroed one has no runs. */
struct label_runs {
    int axes[3];       /**< That of the rows; then those along which row comes after row, and slice after slice. */
    uint32_t *rows;    /**< [dim[axes[1]] dim[axes[2]] + 1] the first run of each row, and one past the last of all;
                            NULL = none. */
    uint16_t *starts;  /**< [runs] the index along axes[0] at which it begins; more than the last may be read. */
    uint16_t *objects; /**< [runs] */
};

/** Finds the runs of @p volume along @p axis; the volume must not change from now on. There are no runs where they
 * would take more than half a byte a voxel or 64 MB, beside 4 bytes a row, where indices or objects have more than 16
 * bits, or without memory. */
void label_runs_init(struct label_runs *out, const struct volume *volume, int axis);
void label_runs_finish(struct label_runs *runs);

/** How many voxels hold the object of the first, among @p count in a row from the linear index @p first on. */
size_t label_run_length(const struct volume *volume, size_t first, size_t count);

/** Tells the processor that a row will be asked for. */
static inline void label_runs_fetch(const struct label_runs *runs, size_t row)
{
    __builtin_prefetch(runs->starts + runs->rows[row]);
    __builtin_prefetch(runs->objects + runs->rows[row]);
}

/** Gives the run that holds index @p first of a row, and the one that holds @p last. */
void label_runs_between(uint32_t out[2], const struct label_runs *runs, size_t row, size_t first, size_t last);

#endif
