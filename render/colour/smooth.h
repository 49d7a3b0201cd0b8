/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Anti-aliasing where it shows: tiles of a drawn picture in which neighbouring pixels differ are drawn again with four
 * rays per pixel. */
#ifndef CONUS_RENDER_COLOUR_SMOOTH_H
#define CONUS_RENDER_COLOUR_SMOOTH_H

#include "render/colour/colour.h"
#include "render/gl/target.h"

/** Smooths @p rgba, the picture of @p view in @p target (bottom row first), whose contents are lost. */
conus_status smooth_edges(float *rgba, const struct target *target, const struct colour_pass *pass,
                          const struct colour_view *view);

#endif
