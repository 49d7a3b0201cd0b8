/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Culling: the clusters of triangles that an n x n buffer can show, nearest first, in batches. Left out are
 * meshes outside the buffer's pyramid (the square one around the cone; a cylinder's prism), clusters that touch no
 * pixel's centre, and whatever lies behind what earlier batches have shown. Conservative: what is left out cannot be
 * seen. */
#ifndef CONUS_RENDER_ID_MESH_CULL_H
#define CONUS_RENDER_ID_MESH_CULL_H

#include "render/id/clusters.h"

/** Optimisations that a benchmark can switch off. The answers do not change. */
enum mesh_step {
    MESH_CULL = 1,     /**< Culls what is outside the pyramid, or touches no pixel's centre. */
    MESH_ORDER = 2,    /**< Taking the nearest first.                                              */
    MESH_OCCLUSION = 4 /**< Culls what lies behind what has been shown. */
};

/** Where the buffer looks from (Eq. 1, Eq. 3): either slope or radius is 0. */
struct mesh_view {
    const double *world_from_device; /**< [16] rigid; looks down its -z.                          */
    double slope;                    /**< Tangent of half the opening angle.                      */
    double radius;                   /**< A cylinder's parallel rays: half the buffer's edge, mm. */
    uint32_t resolution;             /**< n                                                       */
    unsigned without;                /**< Flags of enum mesh_step to leave out.                   */
};

struct mesh_cull;

conus_status mesh_cull_create(struct mesh_cull **out, const struct clusters *clusters);
/** NULL is fine. */
void mesh_cull_destroy(struct mesh_cull *cull);

/** Bytes that one takes. */
size_t mesh_cull_size(const struct clusters *clusters);

/** Begins a view; mesh_cull_hide() must be called before the first batch. */
void mesh_cull_begin(struct mesh_cull *cull, const struct mesh_view *view);

/** Sets how far each pixel's ray gets, in mm ([n n], INFINITY = no limit); NULL = no limit for all. */
void mesh_cull_hide(struct mesh_cull *cull, const double *distances);

/** The next clusters, about @p triangles triangles of them. Returns their number, 0 when there are no more. @p out is
 * borrowed until the next call. */
size_t mesh_cull_batch(const uint32_t **out, struct mesh_cull *cull, size_t triangles);

#endif
