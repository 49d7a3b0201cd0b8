/* SPDX-License-Identifier: BSD-3-Clause */
/* Textures of OpenGL. */
#include "viewer/window/start.h"

#include <epoxy/gl.h>

enum { LEVELS = 4 /* each half as large as the one before; 1 of a picture that is too small for them */ };

void texture_set(struct texture *texture, const uint8_t *rgba, uint32_t width, uint32_t height, bool smooth)
{
    if (texture->width != width || texture->height != height) {
        glDeleteTextures(1, &texture->name);
        glCreateTextures(GL_TEXTURE_2D, 1, &texture->name);
        const bool has_levels = (width > height ? width : height) >> (LEVELS - 1);
        glTextureStorage2D(texture->name, has_levels ? LEVELS : 1, GL_RGBA8, (GLsizei)width, (GLsizei)height);
        glTextureParameteri(texture->name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTextureParameteri(texture->name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        texture->width = width;
        texture->height = height;
    }
    glTextureParameteri(texture->name, GL_TEXTURE_MIN_FILTER, smooth ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST);
    glTextureParameteri(texture->name, GL_TEXTURE_MAG_FILTER, smooth ? GL_LINEAR : GL_NEAREST);
    glTextureSubImage2D(texture->name, 0, 0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    if (smooth) {
        glGenerateTextureMipmap(texture->name);
    }
}

void texture_drop(struct texture *texture)
{
    if (texture->name) {
        glDeleteTextures(1, &texture->name);
    }
    *texture = (struct texture){0};
}
