/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Several parcellations that become one atlas: whose a label is, and whose a voxel. */
#ifndef CONUS_LOADERS_SCENE_PARCELLATIONS_H
#define CONUS_LOADERS_SCENE_PARCELLATIONS_H

#include "atlas/labels/label_voxels.h"
#include "base/buffer.h"
#include "loaders/scene/load_parcellation.h"

/** The parcellations of a manifest: first parcellations_reserve(), then each read and shifted, then united, settled
 * with surfaces (area_plan_settle()), and joined. */
struct parcellations {
    struct parcellation *parts; /**< [count], earlier ones have priority; joined, one for each grid. */
    size_t count;
    struct label_map *voxels; /**< [count] of each part: label -> its voxels, before any is taken away. */
    struct label_table table; /**< Once united: of all, sorted. */
    struct buffer source;     /**< Once united: where the names come from, in words. */
    struct file_sums read;    /**< Once united: the files that were read besides the volumes. */
    struct notes notes;       /**< Once united: all notes. */
};

/** Makes @p count empty parts, whose notes go to @p sink. */
conus_status parcellations_reserve(struct parcellations *out, size_t count, const struct note_sink *sink);
void parcellations_finish(struct parcellations *all);

/** Adds @p offset to @p label; CONUS_ERROR_DATA where it gets too large. */
conus_status label_raise(uint32_t *label, uint32_t offset);
/** Adds @p offset to the labels of voxels and table; areas whose table says no hemisphere get @p hemisphere, unless it
 * is 0. CONUS_ERROR_DATA where a label gets too large. */
conus_status parcellation_shift(struct parcellation *part, uint32_t offset, char hemisphere);

/** Moves tables, sources, notes and lists of files of the parts together. What a table says of a label that has voxels
 * in another part only is left out. CONUS_ERROR_DATA where two parts have voxels with one label. */
conus_status parcellations_unite(struct parcellations *all);

/** Takes from each part the voxels whose centre lies in an area of an earlier one, which notes say; then parts on the
 * same grid become one. */
conus_status parcellations_join(struct parcellations *all);

/** An atlas of them; the notes go there. */
conus_status parcellations_atlas(conus_atlas **out, struct parcellations *all);

#endif
