/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A flat cut through an atlas, drawn on the CPU: the context in grey, areas filled and outlined, meshes as their
 * contours and filled where they are closed, surfaces around them as contours, pathways over them, streamlines over
 * these, at least 1.5 pixels thick, and the cut through a cone. Labels are looked up, never interpolated. What is drawn
 * has smooth borders where a voxel is wider than 1.5 pixels: of the voxels whose centres lie around a pixel in the
 * plane, the object with the largest sum of linear weights. So a border moves by at most half a voxel along each axis,
 * and stays where it is flat. In a plane along the voxels' axes 61 % of a voxel that is alone is left, in the middle.
 * In others an end of it may not be seen.
 *
 * A cut keeps what it found: the next one looks at voxels and triangles again only where they lie elsewhere. */
#ifndef CONUS_RENDER_FLAT_CUT_H
#define CONUS_RENDER_FLAT_CUT_H

#include "atlas/atlas.h"
#include "render/colour/colour.h"
#include "render/draw/draw.h"

/** A cone or cylinder to be drawn; world mm. */
struct cut_cone {
    const double *world_from_cone; /**< Apex and frame, looking down -z.                                         */
    double slope;                  /**< Tangent of half the angle.                                               */
    double radius;                 /**< At the apex: 0 of a cone.                                                */
    double near, far;              /**< Depths along the axis between which it is drawn.                          */
    bool no_line;                  /**< Only its inside is tinted. */
    const uint32_t *areas; /**< [height width] Objects: they keep their colours, and what is transparent stays so; NULL
                              = all is tinted. */
};

/** Takes a line in which the plane cuts a surface, pixels from the upper left corner. @p object as in cut.contours. */
typedef void cut_line(void *user, const double from[2], const double to[2], uint32_t object);

/** Where the cut's pixels are. */
struct cut_place {
    double centre[3];       /**< World position of the picture's middle.                                       */
    double right[3], up[3]; /**< Unit vectors in the world, perpendicular.                                     */
    double mm_per_pixel;
    uint32_t width, height;
};

struct cut_view {
    struct cut_place place;
    const uint8_t *emphasis;      /**< [object_count + 1] of enum emphasis; NULL = all full.                 */
    const uint8_t (*rgb)[3];      /**< [object_count + 1] sRGB of areas, by number: then pale ones are not filled over a
                                     context, and opaque without one. NULL = the atlas's. */
    const uint8_t (*line_rgb)[3]; /**< Likewise of outlines; those of pale ones over a context are a grey that is seen
                                     there. */
    double fill;                  /**< Opacity of areas, 0 to 1; outlines are drawn over it.                          */
    bool no_outlines;
    double window[2];            /**< Grey values shown as black and white.                                         */
    const struct cut_cone *cone; /**< NULL = none.                                                               */
    cut_line *line;              /**< Gets the lines of surfaces, which are then not drawn; NULL = they are. */
    void *line_user;             /**< Passed to `line`. */
};

/** Number in `contours` of a surface around the areas. */
#define CUT_AROUND UINT32_MAX

struct cut {
    const conus_atlas *atlas;
    uint8_t *rgba;        /**< [height width 4] sRGB and opacity 255, top row first.                               */
    uint8_t seen_on[256]; /**< By the grey of the context: the grey of outlines of what is not hit. */
    uint32_t *objects;    /**< [height width] The area, pathway or bundle that a pixel's centre is in; 0 = none.    */

    uint32_t *shown; /**< [height width] Likewise, with smooth borders: as drawn.                             */

    uint8_t *grey;      /**< [height width] Of the context.                                                      */
    uint32_t *contours; /**< [height width] The object whose surface the plane cuts there, or CUT_AROUND; NULL without
                             surfaces. */
    int32_t *turns; /**< [height width] Scratch: the change of a surface's winding at each pixel; NULL without surfaces.
                         0 between calls. */
    size_t pixel_capacity; /**< That of each of these arrays.                                                       */
    uint32_t *surfaces;    /**< Objects with a mesh, the large ones first: they may hold others.                    */
    size_t surface_count;
    uint32_t **streamlines; /**< [tractogram_count] The object of each streamline (bundles_find_objects()). */
    double window[2];       /**< Grey values shown as black and white.                                              */
    struct cut_place of;    /**< Where grey values and objects were found last. */
    bool has_grey, has_objects; /**< `grey` and `objects` are those of `of`. */
};

/** Ready to draw @p atlas, which must not change from then on. */
conus_status cut_init(struct cut *out, const conus_atlas *atlas);
void cut_finish(struct cut *cut);

/** Fills rgba and objects. On failure their contents are undefined. */
conus_status cut_draw(struct cut *cut, const struct cut_view *view);

/** Pixels from the cone's wall, negative inside, at @p column and @p row, where the middle of the first pixel is 0. */
double cut_cone_distance(const struct cut_place *place, const struct cut_cone *cone, double column, double row);

/** Draws the cone over @p rgba, a picture at @p place. */
void cut_draw_cone(uint8_t *rgba, const struct cut_place *place, const struct cut_cone *cone);

/* Outlines of a cut as lines: of areas along their pixels, and of the cone. */

/** Lines of a cut on their way to the list; those of surfaces come from cut_view.line, one item for each object. */
struct cut_lines {
    struct draw_list *out;
    const conus_object *list;
    const uint8_t (*rgb)[3]; /**< [object count + 1] In place of those of `list`; NULL = these. */
    double width;            /**< Of lines, pixels; the cone's is wider. */
    double at[2], limit[2];  /**< The corner in the picture; width and height: what is beyond is left out. */
    uint32_t object;         /**< Object of `points`. */
    double (*points)[2];
    size_t count, capacity;
};

/** Adds a loop around each group of a number's pixels that touch by their sides, and around each hole in it: through
 * the middles of the outermost pixels. Numbers for which @p skips is true have none; NULL = none is skipped.
 * CONUS_ERROR_MEMORY. */
conus_status cut_trace_areas(const struct cut_lines *lines, const uint32_t *objects, uint32_t width, uint32_t height,
                             const bool *skips);

/** Adds the line of a cone or cylinder in the cut. */
void cut_trace_cone(const struct cut_lines *lines, const struct cut_place *place, const struct cut_cone *cone);

/** A cut_line; its user is a struct cut_lines. */
void cut_lines_add(void *user, const double from[2], const double to[2], uint32_t object);

/** Adds what is left, and frees. */
void cut_lines_finish(struct cut_lines *lines);

#endif
