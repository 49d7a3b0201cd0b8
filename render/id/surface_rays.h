/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The meshes and streamlines of an atlas as the rays of a picture meet them, on the CPU: what mesh_layer.h draws
 * with OpenGL. Triangles and tubes are dealt to bands of rows; each band can be filled on a thread of its own. */
#ifndef CONUS_RENDER_ID_SURFACE_RAYS_H
#define CONUS_RENDER_ID_SURFACE_RAYS_H

#include "render/id/mesh_list.h"
#include "render/id/tubes.h"

enum { SURFACE_BAND = 8 /**< Rows of a band. */ };

/** A surface that a ray meets. */
struct surface_hit {
    float normal[3]; /**< On the side that is seen, world axes. */
    float depth;     /**< Along the view axis, mm; 0 = nothing. */
    uint32_t object; /**< Its number; for a streamline tube_colour(), and for a surface's map such a colour, too. */
};

/** The surfaces at the pixels of a band, row by row. */
struct surface_band {
    struct surface_hit *solid;  /**< [SURFACE_BAND * width] Opaque: the nearest one. */
    struct surface_hit *layers; /**< [SURFACE_BAND * width][layer_count] Translucent: of each object the nearest one,
                                   nearer ones first; those of depth 0 end the list early. */
    size_t layer_count;
};

struct surface_rays;

/** As mesh_layer_create(), mesh_layer_update() and mesh_layer_destroy(). */
conus_status surface_rays_create(struct surface_rays **out, const conus_atlas *atlas, uint64_t *memory_left);
conus_status surface_rays_update(struct surface_rays *rays, const conus_atlas *atlas,
                                 const struct tube_colouring *colouring, const bool *const *is_pale);
void surface_rays_destroy(struct surface_rays *rays);

/** Deals triangles and tubes to the bands of a picture, whatever the shift of @p view, which surface_rays_fill() reads.
 * What it points to must stay. CONUS_ERROR_MEMORY. */
conus_status surface_rays_begin(struct surface_rays *rays, const struct mesh_layer_view *view);

/** Memory for a band of the picture that was begun; surface_band_finish() frees it in any case. */
conus_status surface_band_init(struct surface_band *out, const struct surface_rays *rays);
void surface_band_finish(struct surface_band *band);

/** Finds the surfaces of band @p number, by rays @p shift pixels right and up from the pixels' centres. */
void surface_rays_fill(struct surface_band *out, const struct surface_rays *rays, size_t number, const double shift[2]);

#endif
