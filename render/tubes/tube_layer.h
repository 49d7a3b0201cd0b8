/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The streamlines of an atlas as a camera sees them: tubes round their segments, found pixel by pixel in closed form
 * (Eq. 18), where they are straight several at once. Of more than TUBE_POINT_LIMIT points every k-th streamline is
 * drawn; a draft draws fewer: of more than TUBE_DRAFT_LIMIT points about so many, of streamlines from everywhere. Needs
 * a current context. */
#ifndef CONUS_RENDER_TUBES_TUBE_LAYER_H
#define CONUS_RENDER_TUBES_TUBE_LAYER_H

#include "render/gl/camera.h"
#include "render/gl/context.h"
#include "render/tubes/tube_colour.h"

#include <epoxy/gl.h>

enum { TUBE_POINT_LIMIT = 1000000, TUBE_DRAFT_LIMIT = 20000 };

struct tube_layer;

/** Uploads the streamlines of @p atlas, which has some, and takes their size off @p memory_left. */
conus_status tube_layer_create(struct tube_layer **out, const conus_atlas *atlas, uint64_t *memory_left);
/** NULL is fine. */
void tube_layer_destroy(struct tube_layer *layer);

/** Takes over which bundles are hidden in @p atlas now, and colours the streamlines; those for which @p is_pale
 * [tractogram_count][streamline_count] is set are pale. NULL, or NULL of a tractogram: none is. */
conus_status tube_layer_update(struct tube_layer *layer, const conus_atlas *atlas,
                               const struct tube_colouring *colouring, const bool *const *is_pale);

/** Which part of the streamlines is drawn: every so many of them; 1 = all. */
size_t tube_layer_step(const struct tube_layer *layer);

struct tube_layer_view {
    const double *eye;               /**< World mm. */
    const double *camera_from_world; /**< [9] As in mesh.vert.glsl, by rows. */
    float shift[2];                  /**< In halves of the picture. */
    uint32_t width, height;
    bool draft;
    struct gl_listener listener;
};

/** Draws into the framebuffer that is bound, as mesh.frag.glsl does, behind what is there; depths are reversed.
 * CONUS_ERROR_CANCELLED. */
conus_status tube_layer_draw(const struct tube_layer *layer, const struct tube_layer_view *view);

#endif
