/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Several parcellations that become one atlas: whose a label is, and whose a voxel. */
#ifndef CONUS_LOADERS_SCENE_PARCELLATIONS_H
#define CONUS_LOADERS_SCENE_PARCELLATIONS_H

#include "atlas/labels/label_voxels.h"
#include "loaders/scene/load_parcellation.h"
#include "loaders/scene/load_progress.h"

/** The parcellations of a manifest, which are the job's: each is read and shifted, then they are united, settled with
 * surfaces (area_plan_settle()), and joined. */
struct parcellations {
    struct parcellation *parts; /**< [count], earlier ones have priority; joined, one for each grid. */
    size_t count;
    struct label_table table; /**< Once united: of all, sorted; its texts are the job's. */
    const char *source;       /**< Once united: where the names come from, in words. */
};

/** @p label + @p offset; a failure where that gets too large. */
uint32_t label_raise(struct job *job, uint32_t label, uint32_t offset);

/** Adds @p offset to the labels of voxels and table; areas whose table says no hemisphere get @p hemisphere, unless it
 * is 0. CONUS_ERROR_DATA where a label gets too large. */
void parcellation_shift(struct job *job, struct parcellation *part, uint32_t offset, char hemisphere);

/** Moves tables and sources of the parts together. What a table says of a label that has voxels in another part only is
 * left out. CONUS_ERROR_DATA where two parts have voxels with one label. */
void parcellations_unite(struct job *job, struct parcellations *all);

/** Takes from each part the voxels whose centre lies in an area of an earlier one, which notes say; then parts on the
 * same grid become one. */
void parcellations_join(struct job *job, struct parcellations *all);

/** Makes the load's atlas of @p count parts. */
void parcellations_atlas(struct load *load, struct parcellation *parts, size_t count, const struct label_table *table,
                         const char *source);

/** The value of @p label, put in as 0 if it is new. Valid until the next call; a spare one after a failure. */
uint64_t *map_at(struct job *job, struct label_map *map, uint32_t label);

#endif
