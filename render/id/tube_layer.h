/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The streamlines of an atlas as a camera sees them: tubes (tubes.h), found pixel by pixel in closed form (Eq.
 * 18). Needs a current context. */
#ifndef CONUS_RENDER_ID_TUBE_LAYER_H
#define CONUS_RENDER_ID_TUBE_LAYER_H

#include "atlas/atlas.h"
#include "render/gl/camera.h"
#include "render/gl/context.h"
#include "render/id/tubes.h"

struct tube_layer;

/** Uploads the streamlines of @p atlas, which has some, and takes their size off @p memory_left. */
conus_status tube_layer_create(struct tube_layer **out, const conus_atlas *atlas, uint64_t *memory_left);
/** NULL is fine. */
void tube_layer_destroy(struct tube_layer *layer);

/** Updates the hidden bundles, and colours the streamlines (tubes_paint()). */
conus_status tube_layer_update(struct tube_layer *layer, const struct tube_colouring *colouring,
                               const bool *const *is_pale);

struct tube_layer_view {
    const double *eye;               /**< World mm. */
    const double *camera_from_world; /**< [9] As in mesh.vert.glsl, by rows. */
    float shift[2];                  /**< In halves of the picture. */
    uint32_t width, height;
    double draft; /**< mm; draws a draft, in which no tube is thinner. 0 = draws all as they are. */
    struct picture_listener listener;
};

/** Draws into the bound framebuffer as mesh.frag.glsl does, behind what is there; depths are reversed.
 * CONUS_ERROR_CANCELLED. */
conus_status tube_layer_draw(const struct tube_layer *layer, const struct tube_layer_view *view);

#endif
