/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Anti-aliasing where it shows: tiles of a drawn picture in which neighbouring pixels differ are drawn again with four
 * rays per pixel. */
#ifndef CONUS_RENDER_SMOOTH_H
#define CONUS_RENDER_SMOOTH_H

#include "render/colour.h"
#include "render/target.h"

/** Smooths @p rgba, the picture of @p view in @p target (bottom row first), whose contents are lost. */
conus_status smooth_edges(float *rgba, const struct target *target, const struct colour_pass *pass,
                          const struct colour_view *view);

#endif
