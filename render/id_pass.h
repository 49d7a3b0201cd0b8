/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The ID pass: draws which object each pixel of an n x n target meets first, instead of its colour. Needs a current
 * context throughout. One look is: id_pass_begin(); for each volume fill id_pass_rays() and id_pass_draw();
 * id_pass_read(). For all layers: id_pass_begin(); for each volume fill id_pass_rays() and id_pass_pierce(). */
#ifndef CONUS_RENDER_ID_PASS_H
#define CONUS_RENDER_ID_PASS_H

#include "atlas/volume.h"
#include "render/slices.h"

struct id_pass;

/** A pixel's ray in a volume's index space, per mm; on an axis along which it does not move, origin is the centre of
 * its cell, direction 0 and inverse infinity. */
struct id_ray {
    double origin[3], direction[3], inverse[3];
    double per_depth; /**< 1 / cosine to the view axis: mm along the ray per mm of depth. */
};

/** What was drawn, bottom row first. Borrowed until the next id_pass_begin(). */
struct id_pixels {
    const uint32_t *identifiers; /**< [n n] 0 = nothing.                                              */
    const float (*voxels)[4];    /**< [n n] indices i, j, k of the voxel met, and its distance rounded. */
    const double *distances;     /**< [n n] mm along the ray, exact.                                  */
};

/** A piece of a pixel's ray: a run of cells that are drawn as one identifier (Eq. 10). */
struct id_piece {
    uint32_t pixel, identifier;
    double entry, exit; /**< mm along the ray, exact.          */
    uint32_t cell[3];   /**< Indices of its first voxel.       */
};

/** @p identifiers[k] is what object number k is drawn as, the last one also what VOLUME_BLOCKER is drawn as; 0 makes it
 * invisible. */
conus_status id_pass_create(struct id_pass **out, conus_sampling sampling, const uint32_t *identifiers,
                            size_t identifier_count);
/** NULL is fine. */
void id_pass_destroy(struct id_pass *pass);

/** Uploads the objects of @p volume, which is number 0, 1, ... by the order of these calls; takes the textures' size
 * off @p memory_left. */
conus_status id_pass_add_volume(struct id_pass *pass, const struct volume *volume, uint64_t *memory_left);

/** Clears a target of @p resolution squared pixels. */
conus_status id_pass_begin(struct id_pass *pass, uint32_t resolution);

/** One ray per pixel of the target, to be filled in before a draw. */
struct id_ray *id_pass_rays(struct id_pass *pass);

/** Draws volume number @p volume along the rays: its cells (Eq. 5) or, with CONUS_SLICES, on @p slices (Eq. 7).
 * What lies nearer stays; of equally near objects the one with the lower identifier. */
conus_status id_pass_draw(struct id_pass *pass, size_t volume, const struct slices *slices);

conus_status id_pass_read(struct id_pass *pass, struct id_pixels *out);

/** Takes @p count pieces in any order, but those of one pixel as they lie along its ray. */
typedef conus_status (*id_pass_take)(void *user, const struct id_piece *pieces, uint32_t count);

/** Hands to @p take, in portions, all pieces of the pixels' rays in volume number @p volume, whatever hides them. Not
 * for CONUS_SLICES. */
conus_status id_pass_pierce(struct id_pass *pass, size_t volume, id_pass_take take, void *user);

#endif
