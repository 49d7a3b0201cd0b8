/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes as the engines see them: values, one object number per voxel, interpolation, and regions of
 * interest. */
#ifndef CONUS_ATLAS_VOLUME_H
#define CONUS_ATLAS_VOLUME_H

#include "base/status.h"
#include "base/tolerance.h"
#include "conus/atlas.h"
#include "conus/study.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The values of a volume of which most voxels hold the same: pathways and maps of probabilities.
 *
 * Voxels are counted as elsewhere, i fastest. Each VALUE_RUN of them in turn are a run, and of a run that holds nothing
 * but the value of voxel 0, the background, only that is kept. Values are kept as codes of as many bytes as the file
 * has, and a table of what they mean, or as floats. */

enum { VALUE_BOUNDS = 8 }; /**< Of value_map_spread(). */
/** Voxels of a run, and runs of a page. */
enum { VALUE_RUN = 64, VALUE_RUNS = 64, VALUE_PAGE = VALUE_RUN * VALUE_RUNS };

struct value_map {
    size_t count;       /**< Voxels; 0: there is no map. */
    size_t page_count;  /**< Pages that are kept, */
    size_t run_count;   /**< and runs; number 0 of both is the background's. */
    size_t table_count; /**< 0: the codes are floats. */
    size_t width;       /**< Bytes of a code: 1, 2 or 4. */
    uint32_t *pages;    /**< [value_map_pages()] Number of the page with these voxels. */
    uint32_t *runs;     /**< [page_count][VALUE_RUNS] Number of the run with these. */
    void *codes;        /**< [run_count][VALUE_RUN] */
    float *table;       /**< [table_count] The value of each code. */
};

/** Writes the codes of @p count voxels from @p stored on. */
typedef void value_coder(void *user, void *codes, const uint8_t *stored, size_t count);

/** Makes a map of @p count voxels, at least one, of @p size bytes each, with codes of @p width bytes that @p code
 * writes: first that of voxel 0, then those of each run to be kept, in order. The map has no table. */
conus_status value_map_init(struct value_map *out, const void *stored, size_t size, size_t count, size_t width,
                            value_coder *code, void *user);

/** The same of floats as they are. */
conus_status value_map_of(struct value_map *out, const float *values, size_t count);

/** Frees the arrays. */
void value_map_finish(struct value_map *map);

/** Copies a map with its arrays. */
conus_status value_map_copy(struct value_map *out, const struct value_map *map);

/** Whether the counts are those of a map of @p count voxels, and its numbers lead to pages and runs. */
bool value_map_is_sound(const struct value_map *map, size_t count);

/** The first voxel from @p voxel on of which a run is kept; map->count if there is none. */
size_t value_map_next(const struct value_map *map, size_t voxel);

/** Divides all values by @p scale, in double; below 0 and above 1 they become these. */
void value_map_divide(struct value_map *map, double scale);

/** Adds to above[i] how many voxels have values above bounds[i]; there are up to VALUE_BOUNDS. */
void value_map_spread(uint64_t *above, const struct value_map *map, const double *bounds, size_t count);

/** Whether no more than one value is there besides 0, as in a mask of whatever value. */
bool value_map_is_mask(const struct value_map *map);

static inline size_t value_map_pages(size_t voxels)
{
    return voxels / VALUE_PAGE + 1;
}

/** The value of code number @p at. */
static inline float value_map_code(const struct value_map *map, size_t at)
{
    if (map->width == sizeof(float)) {
        return ((const float *)map->codes)[at];
    }
    size_t code = map->width == 1 ? ((const uint8_t *)map->codes)[at] : ((const uint16_t *)map->codes)[at];
    return map->table[code < map->table_count ? code : 0]; /* a damaged one is not followed */
}

static inline float value_map_at(const struct value_map *map, size_t voxel)
{
    const uint32_t *page = map->runs + (size_t)map->pages[voxel / VALUE_PAGE] * VALUE_RUNS;
    size_t run = page[voxel / VALUE_RUN % VALUE_RUNS];
    return value_map_code(map, run * VALUE_RUN + voxel % VALUE_RUN);
}

/* A volume as the engines see it: one object number per voxel, and for scalar volumes the value too. */

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

/** Linear index of the voxel of a grid whose cell holds the indices @p at; false outside the grid. */
bool grid_find_voxel(size_t *voxel, const size_t dim[3], const double at[3]);

/** The same of the world position @p point (Eq. 5). */
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

/* Trilinear interpolation between voxel centres. */

/** A coordinate between two voxels: array offsets of both, and the weight of the second. */
struct volume_neighbours {
    size_t low, high;
    double part;
};

static inline struct volume_neighbours volume_find_neighbours(double x, size_t dim, size_t step)
{
    double most = (double)dim - 1;
    x = x > 0 ? x : 0;
    x = x < most ? x : most;
    ptrdiff_t index = (ptrdiff_t)x; /* to signed numbers and from them is quicker */
    size_t low = (size_t)index;
    return (struct volume_neighbours){low * step, (low + 1 < dim ? low + 1 : low) * step, x - (double)index};
}

/** Of eight voxels the values of the lower ones along the first axis, and how much more the upper ones have: a and b, c
 * and d are the lower and the upper one along the second axis, a and b lower along the third. */
struct volume_cell {
    double a, b, c, d;
    double a_rise, b_rise, c_rise, d_rise;
};

static inline double volume_rise(double *low, const struct volume *volume, size_t row,
                                 const struct volume_neighbours *x)
{
    *low = (double)volume_value(volume, row + x->low);
    return (double)volume_value(volume, row + x->high) - *low;
}

static inline void volume_read_cell(struct volume_cell *out, const struct volume *volume,
                                    const struct volume_neighbours *x, const struct volume_neighbours *y,
                                    const struct volume_neighbours *z)
{
    out->a_rise = volume_rise(&out->a, volume, y->low + z->low, x);
    out->b_rise = volume_rise(&out->b, volume, y->high + z->low, x);
    out->c_rise = volume_rise(&out->c, volume, y->low + z->high, x);
    out->d_rise = volume_rise(&out->d, volume, y->high + z->high, x);
}

/** At parts of the way along the three axes. */
static inline double volume_in_cell(const struct volume_cell *cell, double x, double y, double z)
{
    double low = cell->a + x * cell->a_rise;
    double high = cell->c + x * cell->c_rise;
    low += y * (cell->b + x * cell->b_rise - low);
    high += y * (cell->d + x * cell->d_rise - high);
    return low + z * (high - low);
}

/** Whether a voxel's cell holds @p p, in index space. */
static inline bool volume_reaches(const struct volume *volume, const double p[3])
{
    const size_t *dim = volume->info.dim;
    return p[0] >= -0.5 && p[0] < (double)dim[0] - 0.5 && p[1] >= -0.5 && p[1] < (double)dim[1] - 0.5 && p[2] >= -0.5 &&
           p[2] < (double)dim[2] - 0.5;
}

/** The value at @p p, in index space; outside of the voxel centres that of the border. */
static inline double volume_trilinear(const struct volume *volume, const double p[3])
{
    const size_t *dim = volume->info.dim;
    struct volume_neighbours x = volume_find_neighbours(p[0], dim[0], 1);
    struct volume_neighbours y = volume_find_neighbours(p[1], dim[1], dim[0]);
    struct volume_neighbours z = volume_find_neighbours(p[2], dim[2], dim[0] * dim[1]);
    struct volume_cell cell;
    volume_read_cell(&cell, volume, &x, &y, &z);
    return volume_in_cell(&cell, x.part, y.part, z.part);
}

/* A region of interest: the voxels of a volume, or the tetrahedra of a mesh, whose value reaches a threshold. */

struct tetrahedron {
    uint32_t nodes[4]; /**< From 0. */
    float value;
};

struct conus_roi {
    struct volume volume;   /**< Without objects. Of tetrahedra it is a grid that they lie in, without values. */
    uint64_t voxels;        /**< How many voxels or tetrahedra the region has. */
    double mm3;             /**< Their volume. */
    size_t low[3], high[3]; /**< Bounds of the region in the grid, both ends in it. */
    double (*nodes)[3];     /**< World mm. NULL = it is a region of voxels. */
    struct tetrahedron *tetrahedra; /**< [voxels] Those of the region; the two are owned. */
};

/** Takes over @p values, scaled, one per voxel, on success; info->threshold says which of them count, as
 * conus_roi_options has it. Errors as of conus_roi_load(). */
conus_status roi_create(conus_roi **out, const conus_volume_info *info, float *values);

/** A mesh, all of it. */
struct roi_mesh {
    double (*nodes)[3]; /**< World mm. */
    size_t node_count;
    struct tetrahedron *tetrahedra; /**< Their nodes are there. */
    size_t count;                   /**< At least 1. */
};

/** The same of the tetrahedra of @p mesh, whose arrays it takes over on success. Of @p info only path, sum, format,
 * datatype and threshold are read. */
conus_status roi_create_mesh(conus_roi **out, const conus_volume_info *info, const struct roi_mesh *mesh);

/** mm³, never negative. */
double roi_tetrahedron_mm3(const double (*nodes)[3], const struct tetrahedron *tetrahedron);

/** Whether something of this value belongs to a region of this threshold, which it was perhaps written as. */
static inline bool roi_value_belongs(float value, double threshold)
{
    const float bound = (float)(threshold * (1 - TOLERANCE));
    return threshold > 0   ? value >= bound
           : threshold < 0 ? value <= bound
                           : value != 0 && value == value; /* NaN belongs to nothing */
}

static inline bool roi_has(const conus_roi *roi, size_t voxel)
{
    return roi_value_belongs(roi->volume.values[voxel], roi->volume.info.threshold);
}

/** The value of a voxel or tetrahedron. */
static inline float roi_value(const conus_roi *roi, size_t index)
{
    return roi->nodes ? roi->tetrahedra[index].value : roi->volume.values[index];
}

/** Its middle, world mm. */
void roi_middle(double out[3], const conus_roi *roi, size_t index);

#endif
