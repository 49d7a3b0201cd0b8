/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A flat cut through an atlas, drawn on the CPU: the context in grey, areas filled and outlined, meshes as their
 * contours, pathways over them, and the cut through a cone. Labels are looked up, never interpolated. */
#ifndef CONUS_RENDER_CUT_H
#define CONUS_RENDER_CUT_H

#include "atlas/atlas.h"
#include "render/emphasis.h"

/** A cone or cylinder as the cut sees it; world mm. */
struct cut_cone {
    const double *world_from_cone; /**< Apex and frame, looking down -z.                                         */
    double slope;                  /**< Tangent of half the angle.                                               */
    double radius;                 /**< At the apex: 0 of a cone.                                                */
    double near, far;              /**< Depths along the axis between which it is drawn.                          */
};

struct cut_view {
    double centre[3];       /**< World position of the picture's middle.                                       */
    double right[3], up[3]; /**< Unit vectors in the world, perpendicular.                                     */
    double mm_per_pixel;
    uint32_t width, height;
    const bool *hidden;      /**< [object_count + 1] Objects not to draw; NULL = none.                          */
    const uint8_t *emphasis; /**< [object_count + 1] of enum emphasis; NULL = all full.                 */
    double fill;             /**< Opacity of areas, 0 to 1; outlines are drawn over it.                          */
    bool no_outlines;
    double window[2];            /**< Grey values shown as black and white.                                         */
    const struct cut_cone *cone; /**< NULL = none.                                                               */
};

/** Fills @p rgba, [height width 4] bytes of sRGB and opacity 255, and @p objects, [height width] numbers of the area or
 * pathway that a pixel's centre is in (0 = none; NULL = not wanted), top row first. */
conus_status cut_draw(uint8_t *rgba, uint32_t *objects, const conus_atlas *atlas, const struct cut_view *view);

#endif
