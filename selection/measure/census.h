/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The census (Eq. 10): which voxels have their centre in a region, and what they amount to for each object. Exact: the
 * voxels are those for which region_has() holds, to the last bit. */
#ifndef CONUS_SELECTION_MEASURE_CENSUS_H
#define CONUS_SELECTION_MEASURE_CENSUS_H

#include "atlas/atlas.h"
#include "selection/measure/label_runs.h"
#include "selection/region/region.h"

#include <stdatomic.h>

/** @p count voxels of @p volume in the region, from indices @p at on along i. */
typedef void (*census_row)(void *user, const struct volume *volume, const size_t at[3], size_t count);

/** Calls @p row for all voxels of @p volume in @p region, in the order in which they are stored. */
void census_walk(const struct region *region, const struct volume *volume, census_row row, void *user);

/** The same for those in @p box only. */
void census_walk_box(const struct region *region, const struct volume *volume, const struct object_box *box,
                     census_row row, void *user);

/** The sums over the voxels of an object in a region. */
struct census_count {
    uint64_t voxels;
    uint64_t index[3];     /**< Sums of their i, j and k.                                                   */
    double value, maximum; /**< Sum and largest of their values; 0 of a parcellation's.                     */
    double moment[3];      /**< Sums of value times i, j, k.                                                */
};

/** How the labels of a parcellation are read, by all threads. */
struct census_labels {
    atomic_size_t counted;     /**< Voxels that have been, in all regions, without runs. */
    atomic_bool has_runs;      /**< They were found, and can be read.                    */
    struct label_runs runs[3]; /**< Along each axis; some may have none. */
};

/** Counts of all objects, kept between regions: so the cost of a query depends on what is in its region, not on the
 * size of the atlas. */
struct census {
    struct census_count *counts; /**< [object_count + 1]; [0]: voxels of the parcellation that are no object's. */
    uint32_t *touched;           /**< Objects with voxels, in ascending order; 0 is not among them.         */
    size_t touched_count;
    struct census_labels *labels; /**< [volume_count] Not owned. */
    size_t object_count;
};

/** Makes @p out [volume_count], for any number of censuses of @p atlas at once. */
conus_status census_labels_create(struct census_labels **out, const conus_atlas *atlas);
/** The atlas may be gone; it had @p count volumes. */
void census_labels_destroy(struct census_labels *labels, size_t count);

/** Reserves capacity for the objects of @p atlas, whose @p labels must live as long; a zeroed census is ready for it.
 */
conus_status census_prepare(struct census *census, const conus_atlas *atlas, struct census_labels *labels);
void census_finish(struct census *census);

/** Forgets the last region's counts and takes those of @p region. The context takes no part. */
void census_take(struct census *census, const conus_atlas *atlas, const struct region *region);

/** Whether voxels of @p object count by their values: in a pathway, which is the more there the higher they are. In a
 * band of values they say what is there, not how much. */
bool census_is_weighted(const conus_atlas *atlas, uint32_t object);

/** World position of the centroid of the voxels of @p object, weighted by value where census_is_weighted(). */
void census_centroid(double out[3], const struct census *census, const conus_atlas *atlas, uint32_t object);

#endif
