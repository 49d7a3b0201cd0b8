/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The streamlines of an atlas as pictures show them: tubes around their segments, straight neighbours as one. Of
 * more than TUBE_POINT_LIMIT points every k-th streamline is drawn; a draft draws about TUBE_DRAFT_LIMIT points, of
 * streamlines from everywhere. Needs no GL. */
#ifndef CONUS_RENDER_ID_TUBES_H
#define CONUS_RENDER_ID_TUBES_H

#include "atlas/atlas.h"

enum tube_colour_by {
    TUBE_BY_BUNDLE = 0, /**< The colour of the first of its objects that is shown. */
    TUBE_BY_DIRECTION,  /**< Red from left to right, green from back to front, blue upwards. */
    TUBE_BY_SCALAR      /**< A number of its points or of itself. */
};

struct tube_colouring {
    enum tube_colour_by by;
    char *scalar;     /**< Its name; owned. NULL unless TUBE_BY_SCALAR. */
    double low, high; /**< Values at the ends of the colours. */
};

/* A tube in a mesh layer's texture of objects: the object's number, or TUBE_OWN_COLOUR and sRGB in the lowest
 * three bytes, red first. */
#define TUBE_OWN_COLOUR 0x80000000U
#define TUBE_PALE 0x40000000U /**< Drawn pale, whatever its object. */
#define TUBE_BALL 0x20000000U /**< Until it is drawn: a streamline of one point. */

/** Reads @p name: NULL or "bundle", "direction", or the name of a number that a tractogram of @p atlas has for its
 * points or streamlines, one each. CONUS_ERROR_ARGUMENT, with the names that there are, and for any name where there
 * are no streamlines. */
conus_status tube_colouring_choose(struct tube_colouring *out, const conus_atlas *atlas, const char *name);
void tube_colouring_finish(struct tube_colouring *colouring);

enum {
    TUBE_RAMP_STEPS = 4, /**< Between the colours of a number; between two of them they are mixed in sRGB. */
    TUBE_UNKNOWN = 128   /**< Grey for points without a number or direction: red, green and blue. */
};

/** sRGB of @p part, 0 to 1, of the range of a number; grey where it is NaN. */
void tube_scalar_colour(uint8_t rgb[3], double part);

/** The same of a direction, of any length; its sign does not count. Grey where its length is 0. */
void tube_direction_colour(uint8_t rgb[3], const double direction[3]);

/** The colour of the segment from point @p index of streamline @p number to the next, of @p object. */
uint32_t tube_colour(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                     uint64_t index, uint32_t object);

enum { TUBE_POINT_LIMIT = 1000000, TUBE_DRAFT_LIMIT = 20000 };

/** The tubes of a tractogram: one from each point that is kept to the next, those of a draft first. */
struct tube_range {
    size_t first, count, draft;
    float radius;
};

/** The tubes of an atlas. */
struct tubes {
    const conus_atlas *atlas;
    struct tube_range *ranges; /**< [range_count] of its tractograms. */
    size_t range_count;
    size_t step;    /**< Every step-th streamline is drawn. */
    uint64_t *kept; /**< [point_count] Points that are drawn, of one tractogram after the other. */
    size_t point_count;
};

/** Chooses the points of @p atlas, which has streamlines. Takes what they need in a picture off @p memory_left.
 * CONUS_ERROR_MEMORY. */
conus_status tubes_init(struct tubes *out, const conus_atlas *atlas, uint64_t *memory_left);
void tubes_finish(struct tubes *tubes);

/** World mm, [point_count + 1]: the last one stands twice, since each tube also needs the point behind its own. */
void tubes_points(float (*points)[3], const struct tubes *tubes);

/** What is drawn from each point to the next, [point_count], all 0 before: tube_colour(), with TUBE_BALL and TUBE_PALE;
 * 0 = nothing, for hidden bundles, too. Pale are those with @p is_pale [tractogram_count][streamline_count] set; NULL,
 * or NULL for a tractogram: none is. CONUS_ERROR_MEMORY. */
conus_status tubes_paint(uint32_t *paints, const struct tubes *tubes, const struct tube_colouring *colouring,
                         const bool *const *is_pale);

#endif
