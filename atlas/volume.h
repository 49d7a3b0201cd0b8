/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A volume as the engines see it: one object number per voxel, and for scalar volumes the value too. */
#ifndef CONUS_ATLAS_VOLUME_H
#define CONUS_ATLAS_VOLUME_H

#include "base/status.h"
#include "conus/atlas_info.h"

/** The number of voxels that stop rays and belong to no object. Above every object's number, so that an object that is
 * equally near comes first. */
#define VOLUME_BLOCKER UINT32_MAX

/** Voxels of one hidden object, one after the other. */
struct hidden_run {
    size_t first, count;
    uint32_t object;
};

/** The voxels as they were before a deformation field resampled them. */
struct volume_source {
    size_t dim[3];
    double voxel_from_world[16]; /**< From mm behind the first field. */
    uint16_t *objects16;
    uint32_t *objects32;
    float *values;
    size_t first_warp; /**< The first of the atlas's warps that has moved the volume. */
    bool is_borrowed;
};

/** A box around the centres of all voxels with an object, which `m` maps from their indices. */
struct volume_box {
    double m[16];
    double low[3], high[3]; /**< low above high where no voxel has one. */
};

struct volume {
    conus_volume_info info;
    char *path; /**< Owned; info.path points to it.                                           */
    double voxel_from_world[16];
    size_t voxel_count;             /**< dim[0] dim[1] dim[2]; i runs fastest.                                     */
    uint16_t *objects16;            /**< Object number per voxel, 0 = none. One of the two, by the number of       */
    uint32_t *objects32;            /**< objects; a context volume that blocks nothing has neither.                */
    float *values;                  /**< Scaled value per voxel; NULL for a parcellation.                          */
    bool is_hidden;                 /**< It is a pathway that is hidden.                                           */
    struct hidden_run *hidden_runs; /**< Voxels of a parcellation that hidden objects had. */
    size_t hidden_run_count;
    bool is_joined;               /**< Its labels come from several files, of which info.path is the first.     */
    bool is_borrowed;             /**< The arrays are borrowed and read-only. */
    struct volume_source *source; /**< Owned; NULL = it was never resampled. An attached atlas has none. */
    struct volume_box centres;    /**< The box of borrowed objects with distances; info.world_from_voxel may have
                                       changed since. */
    const void *distances; /**< The distance map of borrowed objects (selection/engine/voxels/distance_map.h), in their
                                memory; NULL = none. */
};

void volume_finish(struct volume *volume);

/** Fills the derived members from @p info: copies path, inverts the affine, counts voxels. */
conus_status volume_init(struct volume *out, const conus_volume_info *info);

/** Copies borrowed arrays, so that they may be changed. On failure the volume is as before. */
conus_status volume_own(struct volume *volume);

/** Whether its objects follow from its values: those of a pathway, or of an area of a probabilistic atlas. */
static inline bool volume_is_scalar(const struct volume *volume)
{
    return volume->info.role == CONUS_ROLE_SCALAR || volume->info.role == CONUS_ROLE_PROBABILITY;
}

/** Whether rays can hit anything in it. */
static inline bool volume_can_be_hit(const struct volume *volume)
{
    return (volume->objects16 || volume->objects32) && !volume->is_hidden;
}

/** Fills in volume->centres, for its world_from_voxel; it has objects. */
void volume_measure_centres(struct volume *volume);

/** Linear index of the voxel whose cell holds the world position @p point (Eq. 5); false outside the grid. */
bool volume_find_voxel(size_t *voxel, const struct volume *volume, const double point[3]);

/** Object of the voxel with linear index @p voxel. */
static inline uint32_t volume_object(const struct volume *volume, size_t voxel)
{
    return volume->objects16 ? volume->objects16[voxel] : volume->objects32[voxel];
}

static inline void volume_set_object(struct volume *volume, size_t voxel, uint32_t object)
{
    if (volume->objects16) {
        volume->objects16[voxel] = (uint16_t)object;
    } else {
        volume->objects32[voxel] = object;
    }
}

/** Prefetches what volume_object() reads for @p voxel. */
static inline void volume_fetch(const struct volume *volume, size_t voxel)
{
    if (volume->objects16) {
        __builtin_prefetch(volume->objects16 + voxel);
    } else {
        __builtin_prefetch(volume->objects32 + voxel);
    }
}

#endif
