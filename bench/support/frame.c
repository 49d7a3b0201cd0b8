/* SPDX-License-Identifier: BSD-3-Clause */
/* A frame, and the renderer and camera of the scenarios with pictures. */
#include "bench/support/frame.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/context.h"

static const uint32_t check_part = 10; /* of the edges */

void frame_size(uint32_t size[2], bool check)
{
    size[0] = FRAME_WIDTH / (check ? check_part : 1);
    size[1] = FRAME_HEIGHT / (check ? check_part : 1);
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

enum { MARGIN_PART = 35 }; /* of the picture's width, on all sides */

void picture_aim(struct camera *camera, struct colour_view *view, const struct camera_frame *frame,
                 const double (*points)[3], size_t count, size_t slices)
{
    double forward[3];
    camera_default_forward(forward);
    camera_frame_points(camera, (const double *)points, count, forward, radians_from_degrees(30), frame);
    *view = (struct colour_view){
        .camera = camera, .width = frame->width, .height = frame->height, .slices = (uint32_t)slices};
}

void picture_aim_at_all(struct picture *picture, const struct bench_options *options, size_t slices)
{
    const struct colour_pass *pass = &picture->renderer->colour;
    uint32_t size[2];
    frame_size(size, options->check);
    uint32_t margin = size[0] / MARGIN_PART;
    const struct camera_frame frame = {size[0], size[1], margin, margin, margin, margin};
    picture_aim(&picture->camera, &picture->view, &frame, (const double(*)[3])pass->content, pass->content_count,
                slices);
}

conus_status picture_begin(struct picture *picture)
{
    conus_status status = gl_context_use(picture->renderer->context, &picture->previous);
    picture->is_current = !status;
    return status ? status : frame_resize(&picture->frame, (uint32_t[]){picture->view.width, picture->view.height});
}

void picture_finish(struct picture *picture)
{
    if (picture->is_current) {
        frame_finish(&picture->frame);
        gl_current_restore(&picture->previous);
    }
    conus_renderer_destroy(picture->renderer);
    *picture = (struct picture){0};
}
