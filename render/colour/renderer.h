/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The renderer's struct: the colour pass of one atlas. */
#ifndef CONUS_RENDER_COLOUR_RENDERER_H
#define CONUS_RENDER_COLOUR_RENDERER_H

#include "render/colour/colour.h"

struct conus_renderer {
    const conus_atlas *atlas;
    struct colour_pass colour;
    struct transfer transfer; /**< The context's, in grey values. */
    uint64_t max_memory;
    conus_log log; /**< May be NULL. */
    void *log_user;
};

/** Draws, beside pathways, the areas that @p areas names (colour_pass_include()) from now on. */
conus_status renderer_include(conus_renderer *renderer, const uint8_t *areas);

/** Draws the streamlines with @p is_pale set in a pale colour from now on (tubes_paint()). */
conus_status renderer_paint_streamlines(conus_renderer *renderer, const bool *const *is_pale);

/** Draws the picture off-screen, with smooth edges if @p smooth. @p rgba gets width * height pixels of linear R, G, B
 * times A, and A, bottom row first. */
conus_status renderer_draw(float *rgba, conus_renderer *renderer, const struct colour_view *view, bool smooth);

#endif
