/* SPDX-License-Identifier: BSD-3-Clause */
/* A frame, and the camera of the scenarios with pictures. */
#include "bench/support/frame.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/gl.h"

void frame_size(uint32_t size[2], bool check)
{
    const uint32_t part = check ? 10 : 1; /* of the edges */
    size[0] = FRAME_WIDTH / part;
    size[1] = FRAME_HEIGHT / part;
}

conus_status frame_resize(struct frame *frame, const uint32_t size[2])
{
    GLsizei width = (GLsizei)size[0], height = (GLsizei)size[1];
    if (frame->width == size[0] && frame->height == size[1]) {
        return CONUS_OK;
    }
    frame_finish(frame);
    *frame = (struct frame){.width = size[0], .height = size[1]};
    glCreateTextures(GL_TEXTURE_2D, 1, &frame->colour);
    glTextureStorage2D(frame->colour, 1, GL_RGBA8, width, height);
    glCreateTextures(GL_TEXTURE_2D, 1, &frame->depth);
    glTextureStorage2D(frame->depth, 1, GL_DEPTH_COMPONENT24, width, height);
    glCreateFramebuffers(1, &frame->framebuffer);
    glNamedFramebufferTexture(frame->framebuffer, GL_COLOR_ATTACHMENT0, frame->colour, 0);
    glNamedFramebufferTexture(frame->framebuffer, GL_DEPTH_ATTACHMENT, frame->depth, 0);
    return gl_check("frame");
}

void frame_finish(struct frame *frame)
{
    if (frame->framebuffer) { /* otherwise there may be no GL at all */
        glDeleteFramebuffers(1, &frame->framebuffer);
        glDeleteTextures(1, &frame->colour);
        glDeleteTextures(1, &frame->depth);
    }
    *frame = (struct frame){0};
}

void frame_begin(const struct frame *frame, bool depth_test)
{
    static const GLenum off[] = {GL_BLEND, GL_DITHER, GL_CULL_FACE, GL_SCISSOR_TEST, GL_DEPTH_TEST, GL_STENCIL_TEST};
    for (size_t i = 0; i < sizeof off / sizeof *off; i++) {
        glDisable(off[i]);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, frame->framebuffer);
    glViewport(0, 0, (GLsizei)frame->width, (GLsizei)frame->height);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glClearBufferfv(GL_COLOR, 0, (float[]){0, 0, 0, 0});
    glClearBufferfv(GL_DEPTH, 0, (float[]){1});
    if (depth_test) {
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
    }
}

conus_status frame_read(const struct frame *frame, float *pixels)
{
    size_t size = (size_t)frame->width * frame->height * 4 * sizeof *pixels;
    glGetTextureImage(frame->colour, 0, GL_RGBA, GL_FLOAT, (GLsizei)size, pixels);
    return gl_check("frame");
}

conus_status frame_coverage(double *out, const struct frame *frame)
{
    size_t pixels = (size_t)frame->width * frame->height, covered = 0;
    float(*rgba)[4] = memory_raw(pixels, sizeof *rgba);
    conus_status status = rgba ? frame_read(frame, *rgba) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < pixels && !status; i++) {
        covered += rgba[i][3] > 0;
    }
    memory_free(rgba);
    *out = (double)covered / (double)pixels;
    return status;
}

void picture_aim(struct camera *camera, struct colour_view *view, const struct camera_frame *frame,
                 const double (*points)[3], size_t count, size_t slices)
{
    double forward[3];
    camera_default_forward(forward);
    camera_frame_points(camera, (const double *)points, count, forward, radians_from_degrees(30), frame);
    *view = (struct colour_view){
        .camera = camera, .width = frame->width, .height = frame->height, .slices = (uint32_t)slices};
}

double picture_rms(const float *a, const float *b, size_t pixels, size_t first, size_t last)
{
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        for (size_t c = first; c <= last; c++) {
            double difference = (double)a[4 * i + c] - (double)b[4 * i + c];
            sum += difference * difference;
        }
    }
    return sqrt(sum / (double)(pixels * (last - first + 1)));
}
