/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Volumes in the paper's way: polygons, cut out of the volumes' box perpendicular to the view, farthest first, each
 * textured, classified and shaded per fragment and blended by the framebuffer. Needs a current context throughout. */
#ifndef CONUS_BENCH_SUPPORT_SLICING_H
#define CONUS_BENCH_SUPPORT_SLICING_H

#include "render/colour/colour_gl.h"

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
