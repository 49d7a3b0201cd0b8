/* SPDX-License-Identifier: BSD-3-Clause */
/* Creates, clears and reads framebuffers. */
#include "render/gl/gl.h"

#include <assert.h>
#include <string.h>

enum { STRIP = 1 << 23 }; /* bytes that are read at once */

/* GL's names of a target_format. */
struct format {
    GLenum internal, layout, type;
    GLsizei size;
};

static const struct format formats[] = {
    [TARGET_UINT] = {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
    [TARGET_UINT2] = {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8},
    [TARGET_FLOAT4] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
    [TARGET_DEPTH] = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4},
};

conus_status target_init(struct target *out, uint32_t width, uint32_t height,
                         const struct target_attachment *attachments, size_t count)
{
    assert(count <= TARGET_ATTACHMENT_LIMIT);
    static const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2,
                                     GL_COLOR_ATTACHMENT3};
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (width > (uint32_t)limit || height > (uint32_t)limit) {
        return fail(CONUS_ERROR_GL, "framebuffer of %u x %u pixels: this driver allows %d x %d", width, height, limit,
                    limit);
    }
    struct target target = {.width = width, .height = height, .count = count};
    glCreateFramebuffers(1, &target.framebuffer);
    if (count) {
        memcpy(target.attachments, attachments, count * sizeof *attachments);
    } else {
        glNamedFramebufferParameteri(target.framebuffer, GL_FRAMEBUFFER_DEFAULT_WIDTH, (GLint)width);
        glNamedFramebufferParameteri(target.framebuffer, GL_FRAMEBUFFER_DEFAULT_HEIGHT, (GLint)height);
    }
    size_t colours = 0;
    for (size_t i = 0; i < count; i++) {
        enum target_format format = target.attachments[i].format;
        GLuint *texture = &target.textures[i];
        glCreateTextures(GL_TEXTURE_2D, 1, texture);
        glTextureStorage2D(*texture, 1, formats[format].internal, (GLsizei)target.width, (GLsizei)target.height);
        glTextureParameteri(*texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureParameteri(*texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        bool is_depth = format == TARGET_DEPTH;
        GLenum point = is_depth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0 + (GLenum)colours;
        glNamedFramebufferTexture(target.framebuffer, point, *texture, 0);
        colours += !is_depth;
    }
    glNamedFramebufferDrawBuffers(target.framebuffer, (GLsizei)colours, buffers);
    conus_status status = gl_check("framebuffer");
    if (!status && glCheckNamedFramebufferStatus(target.framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        status = fail(CONUS_ERROR_GL, "framebuffer: this driver cannot draw into %zu attachments of %u x %u pixels",
                      count, width, height);
    }
    if (status) {
        target_finish(&target);
        return status;
    }
    *out = target;
    return CONUS_OK;
}

void target_finish(struct target *target)
{
    if (target->framebuffer) {
        glDeleteFramebuffers(1, &target->framebuffer);
        glDeleteTextures((GLsizei)target->count, target->textures);
        readback_finish(&target->readback);
    }
    *target = (struct target){0};
}

void target_bind(const struct target *target)
{
    static const GLenum off[] = {GL_BLEND,        GL_DITHER,       GL_CULL_FACE,         GL_MULTISAMPLE,
                                 GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_RASTERIZER_DISCARD};
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    glViewport(0, 0, (GLsizei)target->width, (GLsizei)target->height);
    for (size_t i = 0; i < sizeof off / sizeof off[0]; i++) {
        glDisable(off[i]);
    }
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    if (target->count && target->attachments[target->count - 1].format == TARGET_DEPTH) {
        glEnable(GL_DEPTH_TEST);
        glDepthMask(GL_TRUE);
    } else {
        glDisable(GL_DEPTH_TEST);
    }
}

void target_clear(const struct target *target)
{
    static const GLuint zeros[4] = {0};
    static const GLfloat black[4] = {0};
    static const GLfloat far = 1;
    target_bind(target); /* masks and scissors bound a clear too */
    for (size_t i = 0; i < target->count; i++) {
        switch (target->attachments[i].format) {
        case TARGET_UINT:
        case TARGET_UINT2:
            glClearBufferuiv(GL_COLOR, (GLint)i, zeros);
            break;
        case TARGET_FLOAT4:
            glClearBufferfv(GL_COLOR, (GLint)i, black);
            break;
        case TARGET_DEPTH:
            glClearBufferfv(GL_DEPTH, 0, &far);
            break;
        }
    }
}

static size_t find_attachment(const struct target *target, const char *name)
{
    size_t i = 0;
    while (i < target->count && strcmp(target->attachments[i].name, name) != 0) {
        i++;
    }
    assert(i < target->count);
    return i;
}

GLuint target_texture(const struct target *target, const char *name)
{
    return target->textures[find_attachment(target, name)];
}

conus_status target_read(struct target *target, const char *name, void *pixels)
{
    size_t index = find_attachment(target, name);
    const struct format *format = &formats[target->attachments[index].format];
    const size_t row = (size_t)format->size * target->width;
    const size_t strip = row < STRIP ? STRIP / row : 1; /* rows */
    conus_status status = CONUS_OK;
    for (size_t first = 0, count; first < target->height && !status; first += count) {
        const void *data = NULL;
        count = target->height - first < strip ? target->height - first : strip;
        const struct readback_rows rows = {.texture = target->textures[index],
                                           .width = (GLsizei)target->width,
                                           .first = (GLsizei)first,
                                           .count = (GLsizei)count,
                                           .layout = format->layout,
                                           .type = format->type,
                                           .size = count * row};
        status = readback_wait_for_rows(&target->readback, &rows, &data, "reading the framebuffer");
        if (!status) {
            memcpy((uint8_t *)pixels + first * row, data, rows.size);
        }
    }
    return status;
}
