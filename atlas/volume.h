/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A volume as the engines see it: one object number per voxel, and for scalar volumes the value too. */
#ifndef CONUS_ATLAS_VOLUME_H
#define CONUS_ATLAS_VOLUME_H

#include "atlas/value_map.h"
#include "base/tolerance.h"
#include "conus/atlas.h"

/** The number of voxels that stop rays and belong to no object. Above every object's number, so that an object that is
 * equally near comes first. */
#define VOLUME_BLOCKER UINT32_MAX

/** Voxels of one hidden object, one after the other. */
struct hidden_run {
    size_t first, count;
    uint32_t object;
};

/** Voxels of a scalar volume with low <= value < high are the object @p number. Values are kept as floats, and so are
 * the ends: bands that share an end have neither a gap nor a voxel in common. */
struct volume_step {
    float low, high;
    uint32_t number;
    uint32_t is_hidden; /**< 1: of several steps, one that holds nothing now. */
};

/** Indices of voxels; none: first above last. */
struct object_box {
    size_t first[3], last[3];
};

/** The voxels as they were before a deformation field resampled them. */
struct volume_source {
    size_t dim[3];
    double voxel_from_world[16]; /**< From mm behind the first field. */
    uint16_t *objects16;
    uint32_t *objects32;
    float *values;
    struct value_map map;
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
    size_t voxel_count;        /**< dim[0] dim[1] dim[2]; i runs fastest.                                     */
    uint16_t *objects16;       /**< Object number per voxel, 0 = none. One of the two, by the number of       */
    uint32_t *objects32;       /**< objects; a context volume that blocks nothing, and one of steps, have */
    float *values;             /**< neither. Scaled value per voxel of a context.                            */
    struct value_map map;      /**< Values of a scalar volume. */
    struct volume_step *steps; /**< [step_count] What its voxels are, by their values; sorted by their lower ends, */
    size_t step_count;         /**< and none overlap. */
    struct object_box box;     /**< Round the voxels that are anything by these. */
    bool is_hidden;            /**< It is a pathway that is hidden.                                           */
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

/** Whether its voxels can have objects. */
static inline bool volume_has_objects(const struct volume *volume)
{
    return volume->objects16 || volume->objects32 || volume->step_count;
}

/** The value of a map that means "certainly". */
struct value_scale {
    double value;
    bool is_probability; /**< Not only the map's own largest value. */
    const char *words;   /**< How it was found. */
};

/** How the values of one volume, or of several of a file, are spread. */
struct value_spread {
    double least, largest;
    uint64_t voxels;
    uint64_t above[VALUE_BOUNDS]; /**< Voxels with values above a bound, as value_spread_add() has them. */
};

/** Adds a volume whose info has minimum and maximum. */
void value_spread_add(struct value_spread *spread, const struct value_map *map, const conus_volume_info *info);

/** Probabilities are stored as 0..1, as percent, or over the whole range of an unsigned integer: docs/model.md, Eq. 6,
 * has the rule. What fits none of these is measured by its own largest value. */
struct value_scale value_scale_of(const struct value_spread *spread, const conus_volume_info *info);

/** How many voxels lie below 0 or above the scale @p value by more than rounding. False where these are no strays: as
 * many as make another scale likely, or as deep below 0 as a statistic is. */
bool value_spread_strays(uint64_t *strays, const struct value_spread *spread, double value);

/** Whether rays can hit anything in it. */
static inline bool volume_can_be_hit(const struct volume *volume)
{
    return volume_has_objects(volume) && !volume->is_hidden;
}

static inline bool volume_has_values(const struct volume *volume)
{
    return volume->values || volume->map.count;
}

/** The value of the voxel with linear index @p voxel; it has values. */
static inline float volume_value(const struct volume *volume, size_t voxel)
{
    return volume->values ? volume->values[voxel] : value_map_at(&volume->map, voxel);
}

/** The step that holds @p value, hidden or not; NULL = none, as for NaN. */
const struct volume_step *volume_step_of(const struct volume *volume, float value);

/** The object of voxels with this value, of a volume with steps. */
static inline uint32_t volume_object_of(const struct volume *volume, float value)
{
    if (volume->step_count == 1) {
        return value >= volume->steps->low && value < volume->steps->high ? volume->steps->number : 0;
    }
    const struct volume_step *step = volume_step_of(volume, value);
    return step && !step->is_hidden ? step->number : 0;
}

/** Fills in volume->centres, for its world_from_voxel; it has objects. */
void volume_measure_centres(struct volume *volume);

/** Linear index of the voxel whose cell holds the world position @p point (Eq. 5); false outside the grid. */
bool volume_find_voxel(size_t *voxel, const struct volume *volume, const double point[3]);

/** Object of the voxel with linear index @p voxel. */
static inline uint32_t volume_object(const struct volume *volume, size_t voxel)
{
    return volume->objects16   ? volume->objects16[voxel]
           : volume->objects32 ? volume->objects32[voxel]
                               : volume_object_of(volume, value_map_at(&volume->map, voxel));
}

/** Index along each axis of voxel number @p voxel of a grid. */
static inline void grid_index(double out[3], const size_t dim[3], size_t voxel)
{
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    for (int a = 0; a < 3; a++) {
        out[a] = (double)at[a];
    }
}

/** The object of a voxel that has one. */
static inline uint32_t volume_occupant(const struct volume *volume, size_t voxel)
{
    return volume->step_count == 1 ? volume->steps->number : volume_object(volume, voxel);
}

/** The first voxel from @p voxel on that may have an object, hidden or not; voxel_count if none has. */
size_t volume_next(const struct volume *volume, size_t voxel);

/** Counts the voxels of each step into @p counts[step_count], and fills in volume->box. */
void volume_count_steps(uint64_t *counts, struct volume *volume);

/** Makes a volume of the part of @p volume that begins at voxel @p first and has the size @p dim, with an object number
 * per voxel; volume_finish() it. Its matrices and values are not set. */
conus_status volume_spread(struct volume *out, const struct volume *volume, const size_t first[3], const size_t dim[3]);

static inline void volume_set_object(struct volume *volume, size_t voxel, uint32_t object)
{
    if (volume->objects16) {
        volume->objects16[voxel] = (uint16_t)object;
    } else {
        volume->objects32[voxel] = object;
    }
}

/** Prefetches what volume_occupant() reads for @p voxel. */
static inline void volume_fetch(const struct volume *volume, size_t voxel)
{
    if (volume->objects16) {
        __builtin_prefetch(volume->objects16 + voxel);
    } else if (volume->objects32) {
        __builtin_prefetch(volume->objects32 + voxel);
    }
}

#endif
