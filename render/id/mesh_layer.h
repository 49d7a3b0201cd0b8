/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The meshes and streamlines of an atlas as a camera sees them: which object covers a pixel, its depth and its normal.
 * The colour pass shades them and ends its rays there. Needs a current context throughout. */
#ifndef CONUS_RENDER_ID_MESH_LAYER_H
#define CONUS_RENDER_ID_MESH_LAYER_H

#include "atlas/atlas.h"
#include "render/gl/camera.h"
#include "render/gl/target.h"
#include "render/id/mesh_list.h"
#include "render/id/tube_layer.h"

struct mesh_layer;

/** Uploads the meshes and streamlines of @p atlas and the surfaces around its areas, whose numbers follow those of the
 * objects; there must be some. Takes their size off @p memory_left. */
conus_status mesh_layer_create(struct mesh_layer **out, const conus_atlas *atlas, uint64_t *memory_left);
/** NULL is fine. */
void mesh_layer_destroy(struct mesh_layer *layer);

/** Updates the hidden meshes and bundles, and colours the streamlines: see tube_layer_update(). */
conus_status mesh_layer_update(struct mesh_layer *layer, const conus_atlas *atlas,
                               const struct tube_colouring *colouring, const bool *const *is_pale);

/** Draws into textures of its own; its framebuffer stays bound. CONUS_ERROR_CANCELLED if the listener ends it. */
conus_status mesh_layer_draw(struct mesh_layer *layer, const struct mesh_layer_view *view);

/** Layers of translucent meshes: for each pixel the nearest surface of each object, nearer ones first. */
struct mesh_layer_peels {
    GLuint surface, object; /**< Array textures, like the two below; 0 where there never was a layer. */
    size_t count;           /**< Layers of the last picture, up to MESH_LAYER_PEELS. */
};
struct mesh_layer_peels mesh_layer_peels(const struct mesh_layer *layer);

/** Opaque surfaces, RGBA32F: the normal on the side that is seen, in world axes, and the depth along the view axis in
 * mm; 0 = nothing.
 */
GLuint mesh_layer_surface(const struct mesh_layer *layer);
/** R32UI: the object's number; for a streamline tube_colour(), and for a surface's map such a colour, too. */
GLuint mesh_layer_object(const struct mesh_layer *layer);

#endif
