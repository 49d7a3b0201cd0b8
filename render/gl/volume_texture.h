/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Voxels as a 3-D texture: texel (i, j, k) is voxel (i, j, k). */
#ifndef CONUS_RENDER_GL_VOLUME_TEXTURE_H
#define CONUS_RENDER_GL_VOLUME_TEXTURE_H

#include "base/status.h"
#include "render/gl/functions.h"
#include "render/gl/texel.h"

#include <stdint.h>

/** Uploads @p voxels (i fastest; NULL = volume_texture_fill() will) in the current context. *out is the caller's to
 * glDeleteTextures(). @p memory_left is what may still be used, in bytes; this texture's size is taken off it. Errors:
 * CONUS_ERROR_MEMORY above that, CONUS_ERROR_GL when an edge is longer than the driver allows or the driver has no
 * memory. */
conus_status volume_texture_create(GLuint *out, enum volume_texture_kind kind, const size_t dim[3], const void *voxels,
                                   uint64_t *memory_left);

/** Uploads @p count slices of voxels, from @p first on, into a texture of that kind and size. */
void volume_texture_fill(GLuint texture, enum volume_texture_kind kind, const size_t dim[3], size_t first, size_t count,
                         const void *voxels);

#endif
