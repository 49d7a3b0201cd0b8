/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The device of the colour pass that draws with OpenGL: texels are textures, rays the fragments of a shader. */
#ifndef CONUS_RENDER_COLOUR_COLOUR_GL_H
#define CONUS_RENDER_COLOUR_COLOUR_GL_H

#include "render/colour/colour.h"
#include "render/gl/gl.h"

/** The context of a device that colour_gl_create() made. */
struct gl_context *colour_gl_context(const struct colour_device *device);

/** Prepares everything for drawing @p view without meshes in the device's context, except the draw call, and binds it.
 */
void colour_gl_prepare(const struct colour_pass *pass, const struct colour_view *view);

/** The same, and draws into the bound framebuffer (RGBA float, linear radiance times opacity), if nothing is
 * translucent.
 */
conus_status colour_gl_draw(const struct colour_pass *pass, const struct colour_view *view);

enum colour_program {
    COLOUR_RAYS = 0,   /**< Over one triangle on the screen: what pictures use.                          */
    COLOUR_RAYS_PLAIN, /**< The same, with areas as single samples show them: to compare with COLOUR_SLICES. */
    COLOUR_LAYERS,     /**< Over one triangle where something is translucent.                                */
    COLOUR_SLICES      /**< Polygons on the planes, blended by the framebuffer: the paper's way. The vertex shader hands
                           on the plane's number as `layout(location = 0) flat out float`.                    */
};

/** @p pass NULL = for areas and haze; else the program does not look for what its atlas never has. */
conus_status colour_program_create(GLuint *out, const struct program_shader *vertex, enum colour_program kind,
                                   const struct colour_pass *pass, bool has_context);

#endif
