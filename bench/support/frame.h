/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Scenarios with pictures: a frame buffer, and volumes in the paper's way. */
#ifndef CONUS_BENCH_SUPPORT_FRAME_H
#define CONUS_BENCH_SUPPORT_FRAME_H

#include "bench/support/bench.h"
#include "render/colour/colour.h"
#include "render/colour/colour_gl.h"
#include "render/gl/camera.h"
#include "render/gl/gl.h"

/* A frame buffer as screens have it, 8 bits a channel and a depth, which needs a current context throughout; and
 * helpers of the scenarios with pictures. */

enum { FRAME_WIDTH = 1400, FRAME_HEIGHT = 1050 }; /* the paper's */

struct frame {
    GLuint framebuffer, colour, depth;
    uint32_t width, height;
};

/** The paper's size, or in a check a tenth of its edges. */
void frame_size(uint32_t size[2], bool check);

/** Gives the frame that size, if it has another. A zeroed frame has none. */
conus_status frame_resize(struct frame *frame, const uint32_t size[2]);
void frame_finish(struct frame *frame);

/** Directs drawing to the frame, whatever state was left behind, and clears it. */
void frame_begin(const struct frame *frame, bool depth_test);

/** Bottom row first, RGBA, 0 to 1. @p pixels [width * height][4]. */
conus_status frame_read(const struct frame *frame, float *pixels);

/** Part of the frame's pixels that show something. */
conus_status frame_coverage(double *out, const struct frame *frame);

/** Least part of a frame that its subject must cover; less means that something is wrong. */
#define FRAME_COVERAGE 0.05

/** Points the camera at @p points [count] from the default direction, so that they fill @p frame. */
void picture_aim(struct camera *camera, struct colour_view *view, const struct camera_frame *frame,
                 const double (*points)[3], size_t count, size_t slices);

/** Root mean square of the difference of two RGBA pictures in the channels from @p first to @p last. */
double picture_rms(const float *a, const float *b, size_t pixels, size_t first, size_t last);

/* Volumes in the paper's way: polygons, cut out of the volumes' box perpendicular to the view, farthest first, each
 * textured, classified and shaded per fragment and blended by the framebuffer. Needs a current context throughout. */

struct slicing {
    uint32_t slices;
    GLuint program, buffer, vertices;
    struct slicing_vertex *polygons; /**< Farthest first. */
};

conus_status slicing_init(struct slicing *out, uint32_t slices);
void slicing_finish(struct slicing *slicing);

/** Draws into the framebuffer that is bound, over what is there. @p view is one of @p pass with as many slices. */
void slicing_draw(struct slicing *slicing, const struct colour_pass *pass, const struct colour_view *view);

#endif
