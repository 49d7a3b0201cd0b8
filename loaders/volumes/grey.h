/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether the whole numbers of a volume are labels, or an image's grey values. docs/formats.md has the rule and
 * how it was measured. */
#ifndef CONUS_LOADERS_VOLUMES_GREY_H
#define CONUS_LOADERS_VOLUMES_GREY_H

#include "atlas/labels/label_voxels.h"
#include "atlas/labels/labels.h"
#include "loaders/volumes/volume_file.h"

/** Other evidence that the numbers are labels. */
struct grey_claims {
    const struct label_table *table; /**< Sorted; NULL or empty: none.                             */
    bool stated;                     /**< The volume's name, or its own FSL atlas XML, says so. */
};

struct grey_result {
    bool grey;
    bool telling;  /**< There are voxels and values enough to tell; else grey is false.                 */
    double equal;  /**< Share of equal ones among neighbours that are neither 0 nor a plateau. */
    double needed; /**< Share that labels have at least; set where it had to be worked out, else 0.     */
};

/** Judges @p labels, i fastest; not grey after a failure. In an image most neighbours differ, and by less than voxels
 * far apart; areas are pieces, whose voxels have equal neighbours. */
struct grey_result grey_judge(struct job *job, const struct label_voxels *labels, const size_t dim[3],
                              const struct grey_claims *claims);

/** The same of the chosen volume of @p file. That is not grey where its intent code says labels, and is stated to be
 * labels where its name ends in "_dseg", as BIDS wants it, or @p stated. @p table may be NULL. */
struct grey_result grey_judge_file(struct job *job, const struct volume_file *file, const struct label_voxels *labels,
                                   const struct label_table *table, bool stated);

#endif
