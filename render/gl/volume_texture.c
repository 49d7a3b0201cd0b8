/* SPDX-License-Identifier: BSD-3-Clause */
/* Creates 3-D textures within the limits of driver and memory. */
#include "render/gl/gl.h"

/* GL's names of a volume_texture_kind. */
struct format {
    GLenum internal, layout, type;
    GLint filter;
    size_t size;
};

static const struct format formats[] = {
    [VOLUME_TEXTURE_UINT8] = {GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, GL_NEAREST, 1},
    [VOLUME_TEXTURE_UINT16] = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, GL_NEAREST, 2},
    [VOLUME_TEXTURE_UINT32] = {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, GL_NEAREST, 4},
    [VOLUME_TEXTURE_FLOAT] = {GL_R32F, GL_RED, GL_FLOAT, GL_LINEAR, 4},
    [VOLUME_TEXTURE_BYTE4] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR, 4},
    [VOLUME_TEXTURE_HALF4] = {GL_RGBA16F, GL_RGBA, GL_FLOAT, GL_LINEAR, 8},
    [VOLUME_TEXTURE_FLOAT4] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_NEAREST, 16},
};

void volume_texture_fill(GLuint texture, enum volume_texture_kind kind, const size_t dim[3], size_t first, size_t count,
                         const void *voxels)
{
    const struct format *format = &formats[kind];
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage3D(texture, 0, 0, 0, (GLint)first, (GLsizei)dim[0], (GLsizei)dim[1], (GLsizei)count,
                        format->layout, format->type, voxels);
}

conus_status volume_texture_create(GLuint *out, enum volume_texture_kind kind, const size_t dim[3], const void *voxels,
                                   uint64_t *memory_left)
{
    const struct format *format = &formats[kind];
    GLint limit = 0;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
    for (int axis = 0; axis < 3; axis++) {
        if (dim[axis] > (size_t)limit) {
            return fail(CONUS_ERROR_GL, "volume of %zu x %zu x %zu voxels: this OpenGL driver allows %d along an edge",
                        dim[0], dim[1], dim[2], limit);
        }
    }
    const size_t bytes = dim[0] * dim[1] * dim[2] * format->size; /* fits: GL's limit is below 2^16 */
    if (bytes > *memory_left) {
        return fail(CONUS_ERROR_MEMORY,
                    "texture of %zu x %zu x %zu voxels needs %zu bytes: %llu are left of the allowed memory", dim[0],
                    dim[1], dim[2], bytes, (unsigned long long)*memory_left);
    }
    GLuint texture = 0;
    GLsizei width = (GLsizei)dim[0], height = (GLsizei)dim[1], depth = (GLsizei)dim[2];
    glCreateTextures(GL_TEXTURE_3D, 1, &texture);
    glTextureStorage3D(texture, 1, format->internal, width, height, depth);
    if (voxels) {
        volume_texture_fill(texture, kind, dim, 0, dim[2], voxels);
    }
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, format->filter);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, format->filter);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    conus_status status = gl_check("volume texture");
    if (status) {
        glDeleteTextures(1, &texture);
        return status;
    }
    *memory_left -= bytes;
    *out = texture;
    return CONUS_OK;
}
