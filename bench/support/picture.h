/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What scenarios with pictures share: a renderer whose context is current, a camera that frames what shows, and
 * a frame to draw into. */
#ifndef CONUS_BENCH_SUPPORT_PICTURE_H
#define CONUS_BENCH_SUPPORT_PICTURE_H

#include "bench/bench.h"
#include "bench/support/frame.h"
#include "render/colour/renderer.h"

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
