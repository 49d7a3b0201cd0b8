/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * An off-screen framebuffer with named attachments. Everything happens in the current context; no multisampling,
 * blending or dithering ever touches a target of integers. */
#ifndef CONUS_RENDER_GL_TARGET_H
#define CONUS_RENDER_GL_TARGET_H

#include "base/status.h"
#include "render/gl/functions.h"
#include "render/gl/readback.h"

#include <stdint.h>

enum { TARGET_ATTACHMENT_LIMIT = 4 };

enum target_format {
    TARGET_UINT = 1, /**< R32UI: one uint32_t per pixel.         */
    TARGET_UINT2,    /**< RG32UI: two.                           */
    TARGET_FLOAT4,   /**< RGBA32F: four floats.                  */
    TARGET_DEPTH     /**< DEPTH_COMPONENT32F: one float.         */
};

struct target_attachment {
    const char *name; /**< Static. */
    enum target_format format;
};

struct target {
    GLuint framebuffer;
    uint32_t width, height;
    struct target_attachment attachments[TARGET_ATTACHMENT_LIMIT]; /**< Colours are outputs 0, 1, ... in this order. */
    GLuint textures[TARGET_ATTACHMENT_LIMIT];                      /**< One per attachment, NEAREST.               */
    size_t count;
    struct readback readback; /**< Of target_read(). */
};

/** Makes a target; at most one attachment is a depth, the last; without any, shaders write to buffers. CONUS_ERROR_GL
 * when the driver has no such framebuffer or no memory for it. */
conus_status target_init(struct target *out, uint32_t width, uint32_t height,
                         const struct target_attachment *attachments, size_t count);
void target_finish(struct target *target);

/** Binds the target for drawing, whatever state was left behind: viewport over all of it, no blending, dithering,
 * culling, multisampling, scissors or masks; a depth test if it has a depth. */
void target_bind(const struct target *target);

/** target_bind(), and sets colours to 0 and depth to 1. */
void target_clear(const struct target *target);

/** Texture of the attachment called @p name, which must be there. */
GLuint target_texture(const struct target *target, const char *name);

/** Copies attachment @p name to @p pixels, bottom row first, waiting for the drawing: width * height * the format's
 * size in bytes. */
conus_status target_read(struct target *target, const char *name, void *pixels);

#endif
