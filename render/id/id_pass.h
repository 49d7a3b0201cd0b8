/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The ID pass: which object each of many rays hits first. The rays are those of the pixels of as many cones as one
 * likes, so a block of cones is one dispatch per volume and one wait. Needs a current context throughout. One
 * trace is: id_pass_begin(); for each volume fill id_pass_rays() and id_pass_trace(); id_pass_read(). For all layers:
 * id_pass_begin(); for each volume fill id_pass_rays() and id_pass_pierce(). */
#ifndef CONUS_RENDER_ID_ID_PASS_H
#define CONUS_RENDER_ID_ID_PASS_H

#include "atlas/volume.h"
#include "conus/selection.h"
#include "render/gl/functions.h"
#include "render/id/slices.h"

struct id_pass;

/** A ray in a volume's index space, per mm; with exact sampling, on an axis along which it does not move, origin is the
 * centre of its cell, direction 0 and inverse infinity. Neighbours should be neighbours in the list: they are walked in
 * step. */
struct id_ray {
    double origin[3], direction[3];
    union {
        double inverse[3]; /**< Exact sampling.                                     */
        struct {
            double start, spacing, count; /**< Its cone's struct slices.              */
            double per_depth;             /**< 1 / cosine to the view axis: mm along the ray per mm of depth. */
        } planes;                         /**< CONUS_SAMPLING_SLICES.                                      */
    };
};

/** The first hit of a ray. */
struct id_hit {
    double distance;     /**< mm along the ray, exact; INFINITY = nothing.    */
    uint32_t identifier; /**< 0 = nothing.                                    */
    uint32_t cell[3];    /**< Indices of the voxel.                           */
};

/** An interval of a ray: a run of cells with one identifier (Eq. 10). */
struct id_interval {
    uint32_t ray, identifier;
    double entry, exit; /**< mm along the ray, exact.          */
    uint32_t cell[3];   /**< Indices of its first voxel.       */
};

/** @p identifiers[k] is the caller's number of object k; the last one is that of VOLUME_BLOCKER. 0 makes an object
 * invisible. */
conus_status id_pass_create(struct id_pass **out, conus_sampling sampling, const uint32_t *identifiers,
                            size_t identifier_count);
/** NULL is fine. */
void id_pass_destroy(struct id_pass *pass);

/** How far around each voxel a volume is empty. */
struct id_distances {
    const uint8_t *codes; /**< [voxels] 0 where the voxel holds an object; else 1 + r, where no voxel that differs from
                             it by at most r in every index does.                                        */
    int box[2][3];        /**< The first and the last voxel with objects; last below first where there are none. */
};

/** Binds the textures of volume number @p volume and the table of identifiers for the program in use, which begins with
 * id.comp.glsl, and sets its uniform box. */
void id_pass_bind(const struct id_pass *pass, size_t volume);

/** The units of id_pass_bind()'s textures. */
enum { ID_OBJECTS_UNIT, ID_DISTANCE_UNIT, ID_IDENTIFIER_UNIT };

/** Uploads the objects of @p volume, which is number 0, 1, ... by the order of these calls; takes the textures' size
 * off @p memory_left. */
conus_status id_pass_add_volume(struct id_pass *pass, const struct volume *volume, const struct id_distances *distances,
                                uint64_t *memory_left);

size_t id_pass_volume_count(const struct id_pass *pass);

/** The matrix [16] of volume number @p volume. */
const double *id_pass_index_from_world(const struct id_pass *pass, size_t volume);

/** Reserves memory for @p rays rays, at least 1. */
conus_status id_pass_begin(struct id_pass *pass, uint32_t rays);

/** The rays, to be filled in before each volume; NULL = no memory. */
struct id_ray *id_pass_rays(struct id_pass *pass);

/** A buffer of struct id_ray, which the device is to fill before each volume instead, until the next
 * id_pass_begin(). */
GLuint id_pass_device_rays(struct id_pass *pass);

/** Traces the rays through volume number @p volume: its cells (Eq. 5) or, with CONUS_SAMPLING_SLICES, the rays' planes
 * (Eq. 7). Nearer hits found before stay; of equally near objects the lower identifier wins. */
conus_status id_pass_trace(struct id_pass *pass, size_t volume);

/** The first hit of each ray, after at least one id_pass_trace(); borrowed until the next id_pass_begin(). */
conus_status id_pass_read(struct id_pass *pass, const struct id_hit **out);

/** Receives @p count intervals in any order, but those of one ray in the order along it. */
typedef conus_status (*id_pass_take)(void *user, const struct id_interval *intervals, uint32_t count);

/** Hands to @p take, in portions, all intervals of the rays in volume number @p volume, whatever hides them. Not for
 * CONUS_SAMPLING_SLICES. */
conus_status id_pass_pierce(struct id_pass *pass, size_t volume, id_pass_take take, void *user);

#endif
