/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Several rows of a volume's voxels against a region, side by side: which voxels are in it beyond doubt, and which may
 * be. region_has() decides about those between. */
#ifndef CONUS_SELECTION_MEASURE_REGION_ROWS_H
#define CONUS_SELECTION_MEASURE_REGION_ROWS_H

#include "selection/region/region.h"

/** A line at + t step as a region sees it: numbers that are linear in t, [0] at t = 0 and [1] per t. It is in the
 * region where the length of `across` is not above the width, within the range of depths. */
struct region_line {
    double depth[2];
    double width[2];
    double across[2][3];
};

enum { REGION_ROWS = 64 };

/** First and last index along its axis, of each row; [0] above [1] where there is none. */
struct region_cut {
    uint64_t maybe[2][REGION_ROWS]; /**< Voxels that may be in the region: none beyond them is. */
    uint64_t sure[2][REGION_ROWS];  /**< Those among them that are.                             */
};

struct region_rows;

/** Cuts @p count rows from number @p j on, at most REGION_ROWS, to the indices @p limit[0] to @p limit[1]. */
typedef void region_rows_cutter(struct region_cut *out, const struct region_rows *rows, size_t j, size_t count,
                                const size_t limit[2]);

/** All rows of a slice. */
struct region_rows {
    region_rows_cutter *cut; /**< The fastest. */
    const struct region *region;
    const double *world_from_voxel;
    int across_slices;                      /**< The axis along which a slice comes after the other. */
    double margin;                          /**< mm: nearer to the region's border than that is doubt. */
    struct region_line row;                 /**< From the slice's first voxel along the rows, and      */
    struct region_line column;              /**< from row to row.                                      */
    double curve;                           /**< For the rows: width[1]^2 - |across[1]|^2.                  */
    double per_depth, per_width, per_curve; /**< 1 / row.depth[1], 1 / row.width[1], 1 / curve.            */
};

/** For the rows of @p volume along its axis @p axes[0], those along axes[1] being a slice; region_rows_place() must
 * follow. */
void region_rows_init(struct region_rows *out, const struct region *region, const struct volume *volume,
                      const int axes[3]);

/** Goes to slice @p k. */
void region_rows_place(struct region_rows *rows, size_t k);

/** Keeps of the rows @p range [0] to @p range [1] of the slice those that may have a voxel in the region: the others
 * have none. False where none may. */
bool region_rows_narrow(size_t range[2], const struct region_rows *rows);

/* By instruction set, all of them from region_rows_lanes.h, with the same bits. */
region_rows_cutter region_rows_cut_avx512, region_rows_cut_avx2, region_rows_cut_plain;

/** Kernel @p index among those that this machine can run, the fastest first; NULL past the last. */
region_rows_cutter *region_rows_kernel(size_t index);

#endif
