/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The field of a volume, which the colour pass samples: for each voxel a density and its gradient, four bytes in the
 * layout of the texture; for each brick of 4^3 voxels the range of densities, which gives the empty space around a ray.
 * A field covers the box of voxels around which anything is visible. */
#ifndef CONUS_RENDER_COLOUR_FIELD_H
#define CONUS_RENDER_COLOUR_FIELD_H

#include "atlas/volume.h"

#include <pthread.h>

enum { BRICKS_EDGE = 4 };

struct bricks {
    size_t dim[3];     /**< Bricks along i, j, k; the last may reach beyond the grid.                    */
    uint8_t *distance; /**< [dim[0] dim[1] dim[2]], i fastest. 0 = occupied; d = all bricks within d - 1 in every index
                            are empty (at most 255). */
};

void bricks_finish(struct bricks *bricks);

/** Sets the distances. Before the call occupied bricks are 0 and all others 255. */
void bricks_spread(struct bricks *bricks);

enum {
    FIELD_LEVELS = 256,  /**< Densities are bytes.                         */
    FIELD_SURFACE = 128, /**< Labels: the density at which an area begins. */
};

struct field {
    size_t first[3], dim[3]; /**< The box: from which voxel of the volume on, that of a brick, and how many voxels. */
    uint8_t *density;        /**< [voxels] */
    uint8_t *slopes;         /**< [voxels] whose gradients are taken; NULL = the density. */
    double voxel_from_world[16];
    size_t brick_dim[3];
    uint8_t *low, *high; /**< [bricks] range of the densities that a trilinear sample in the brick, or up to one voxel
                              outside it, can take. */
};

/** Density change per mm, of the whole range, at which the stored gradient has half its full length. */
#define FIELD_SOFTNESS 0.03

/** How grey values become densities. */
struct field_scale {
    double low, high; /**< Values that become densities 0 and 255; others are clamped. */
    int unseen;       /**< Densities up to this one, and samples between them, are invisible; -1 = all may be visible.
                       */
};

/** Grey values; central differences. @p out is the caller's to finish in any case, as below. */
conus_status field_of_values(struct field *out, const struct volume *volume, const struct field_scale *scale);

/** Voxels of any object: their blurred occupancy (binomial, sigma 1 voxel), held above FIELD_SURFACE in voxels of
 * objects and below it in others, so that the surface is smooth and yet no voxel changes sides; what is one voxel thick
 * stays so. Gradients are of what is blurred and held again and again, so that terraces become slopes, and then blurred
 * twice. */
conus_status field_of_objects(struct field *out, const struct volume *volume);

void field_finish(struct field *field);

/** The texels of @p count slices from @p first on: @p out gets [count * voxels of a slice][4], the gradient in world
 * axes (128 = 0) as g / (|g| + FIELD_SOFTNESS), and the density. */
void field_texels(uint8_t *out, const struct field *field, size_t first, size_t count);

/** Bricks and their distances to the next one with a density that @p visible names. It has @p per_level entries for
 * each step between densities and one for the last: entry i is density i / per_level. @p out is the caller's to finish
 * in any case. */
conus_status field_bricks(struct bricks *out, const struct field *field, const bool *visible, size_t per_level);

/** Some slices of texels (field_texels()). */
struct field_slab {
    const uint8_t *texels;
    size_t first, count; /**< Slices. */
};

/** A field under way. A zeroed one is empty. */
struct field_task {
    const struct volume *volume; /**< NULL = of nothing. */
    bool is_values;              /**< The field holds grey values, by `scale`; else objects. */
    struct field_scale scale;
    size_t taken; /**< Slabs taken so far; only the caller's thread uses it. */
    bool has_thread;
    pthread_t thread;
    pthread_mutex_t lock;   /**< If there is a thread: guards the members below. */
    pthread_cond_t changed; /**< Signalled with each change of one. */
    bool is_made, stop;
    conus_status status;
    struct field field;
    uint8_t *texels;        /**< Those of some slabs. */
    size_t ready, released; /**< Slabs that have been made, and those of them that may be overwritten. */
};

/** Begins to make the field of @p task, whose volume is read until field_task_end(). */
void field_task_start(struct field_task *task);

/** Waits for the field, which stays the task's. Makes it here if no thread was begun. CONUS_ERROR_MEMORY. */
conus_status field_task_wait(const struct field **out, struct field_task *task);

/** After field_task_wait(): the next slices, from the first on. They stay valid until the next call. False after the
 * last. */
bool field_task_next(struct field_slab *out, struct field_task *task);

/** Cancels what is under way and frees it. */
void field_task_end(struct field_task *task);

#endif
