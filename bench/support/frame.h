/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A frame as screens have it, 8 bits a channel and a depth; and a renderer whose context is current, with a
 * camera that frames what shows. Frames need a current context throughout. */
#ifndef CONUS_BENCH_SUPPORT_FRAME_H
#define CONUS_BENCH_SUPPORT_FRAME_H

#include "bench/support/bench.h"
#include "render/colour/renderer.h"

#include <epoxy/gl.h>

enum { FRAME_WIDTH = 1400, FRAME_HEIGHT = 1050 }; /* the paper's */

struct frame {
    GLuint framebuffer, colour, depth;
    uint32_t width, height;
};

/** The paper's size, or in a check a tenth of its edges. */
void frame_size(uint32_t size[2], bool check);

/** Gives it that size, if it has another. Zeroed is a frame without any. */
conus_status frame_resize(struct frame *frame, const uint32_t size[2]);
void frame_finish(struct frame *frame);

/** Lets drawing go to it, whatever state was left behind, and clears it. */
void frame_begin(const struct frame *frame, bool depth_test);

/** Bottom row first, RGBA, 0 to 1. @p pixels [width * height][4]. */
conus_status frame_read(const struct frame *frame, float *pixels);

/** Part of its pixels that show something. */
conus_status frame_coverage(double *out, const struct frame *frame);

/** Least part that the subject of a frame must cover, or something is wrong with it. */
#define FRAME_COVERAGE 0.05

struct picture {
    conus_renderer *renderer; /**< Created by the scenario; picture_finish() destroys it. */
    struct gl_current previous;
    bool is_current; /**< Between picture_begin() and picture_finish(). */
    struct camera camera;
    struct colour_view view;
    struct frame frame;
};

/** Points the camera at @p points [count] from the default direction, so that they fill @p frame. */
void picture_aim(struct camera *camera, struct colour_view *view, const struct camera_frame *frame,
                 const double (*points)[3], size_t count, size_t slices);

/** The same at everything that the renderer shows, in the paper's size with a margin of 1/35 of the width. */
void picture_aim_at_all(struct picture *picture, const struct bench_options *options, size_t slices);

/** Makes the renderer's context current and gives the frame the size of the view. */
conus_status picture_begin(struct picture *picture);

/** Ends what picture_begin() began, even if it failed, and destroys the renderer. */
void picture_finish(struct picture *picture);

#endif
