/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What colour each part of a streamline has in pictures. */
#ifndef CONUS_RENDER_TUBES_TUBE_COLOUR_H
#define CONUS_RENDER_TUBES_TUBE_COLOUR_H

#include "atlas/atlas.h"

enum tube_colour_by {
    TUBE_BY_BUNDLE = 0, /**< As its object: the first one that is shown. */
    TUBE_BY_DIRECTION,  /**< Red from left to right, green from back to front, blue upwards. */
    TUBE_BY_SCALAR      /**< A number of its points or of itself. */
};

struct tube_colouring {
    enum tube_colour_by by;
    char *scalar;     /**< Its name; owned. NULL unless TUBE_BY_SCALAR. */
    double low, high; /**< Of its values: the ends of the colours. */
};

/* What a mesh layer's texture of objects has of a tube: an object's number, or TUBE_OWN_COLOUR and sRGB in the lowest
 * three bytes, red first. */
#define TUBE_OWN_COLOUR 0x80000000U
#define TUBE_PALE 0x40000000U /**< Drawn pale, whatever its object. */

/** Reads @p name: NULL or "bundle", "direction", or the name of a number that a tractogram of @p atlas has for its
 * points or streamlines, one each. CONUS_ERROR_ARGUMENT, with the names that there are, and for any name where there
 * are no streamlines. */
conus_status tube_colouring_choose(struct tube_colouring *out, const conus_atlas *atlas, const char *name);
void tube_colouring_finish(struct tube_colouring *colouring);

/** sRGB of @p part, 0 to 1, of the range of a number; grey where it is NaN. */
void tube_scalar_colour(uint8_t rgb[3], double part);

/** The same of a direction, of any length; its sign does not count. */
void tube_direction_colour(uint8_t rgb[3], const double direction[3]);

/** The colour of the segment from point @p index of streamline @p number to the next, of @p object. */
uint32_t tube_colour(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                     uint64_t index, uint32_t object);

#endif
