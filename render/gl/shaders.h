/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The shaders of render/shaders/, embedded by the build: NAME.glsl is shader_NAME, dots as underscores. */
#ifndef CONUS_RENDER_GL_SHADERS_H
#define CONUS_RENDER_GL_SHADERS_H

extern const char shader_colour_frag[];
extern const char shader_colour_layers[];
extern const char shader_common[];
extern const char shader_id_frag[];
extern const char shader_mesh_frag[];
extern const char shader_mesh_hits_frag[];
extern const char shader_mesh_id_frag[];
extern const char shader_mesh_id_vert[];
extern const char shader_mesh_vert[];
extern const char shader_screen_vert[];
extern const char shader_tube_frag[];
extern const char shader_tube_vert[];

#endif
