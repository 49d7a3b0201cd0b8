/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlas as a whole, and how loaders and phantoms put one together. */
#ifndef CONUS_ATLAS_ATLAS_H
#define CONUS_ATLAS_ATLAS_H

#include "atlas/labels.h"
#include "atlas/volume.h"
#include "base/notes.h"

struct conus_atlas {
    struct volume *volumes; /**< [0] the parcellation, then pathways and context as they were added.       */
    size_t volume_count;
    conus_object *objects; /**< [object_count]; object number k is objects[k - 1]. Strings are owned.     */
    size_t *object_volume; /**< [object_count] index of the volume that holds the object.                 */
    size_t object_count;
    size_t area_count; /**< The first so many objects are areas.                                      */
    char *label_source;
    struct notes notes;
};

/** Makes an atlas from a labelled volume. @p labels has one label per voxel of @p info (0 = background); areas are
 * the labels present and those that @p table (sorted) names, numbered densely by label. @p notes are moved into the
 * atlas, with what is found here added: labels without names, names without voxels, parents that are missing or
 * cyclic (such links are dropped). */
conus_status atlas_create(conus_atlas **out, const conus_volume_info *info, const uint32_t *labels,
                          const struct label_table *table, const char *label_source, struct notes *notes);

/** An atlas with the parcellation's volume, still without objects: the first step of atlas_create(). */
conus_status atlas_start(conus_atlas **out, const conus_volume_info *info, const char *label_source);

/** Appends a copy of @p object, which lies in volume number @p volume. */
conus_status atlas_append_object(conus_atlas *atlas, const conus_object *object, size_t volume);

/** Adds a scalar volume as a pathway of the voxels with values >= info->threshold. @p values (one per voxel) is
 * taken over on success. */
conus_status atlas_add_pathway(conus_atlas *atlas, const conus_volume_info *info, float *values, const char *name);

/** Sets the context volume, replacing one that was there. @p values is taken over on success. */
conus_status atlas_set_context(conus_atlas *atlas, const conus_volume_info *info, float *values);

/** The context volume, or NULL. */
const struct volume *atlas_context(const conus_atlas *atlas);

/** The volume that holds object @p number. */
const struct volume *atlas_object_volume(const conus_atlas *atlas, uint32_t number);

#endif
