/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file space.h
 * The spaces of positions: where their numbers count from, in which order and unit (docs/spaces.md).
 */
#ifndef CONUS_PUBLIC_SPACE_H
#define CONUS_PUBLIC_SPACE_H

#include <conus/atlas.h>

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A space of positions. */
typedef enum conus_space {
    CONUS_SPACE_RAS = 0, /**< The world: +x right, +y anterior, +z superior, mm.                                     */
    CONUS_SPACE_LPS,     /**< +x left, +y posterior, +z superior, mm.                                                */
    CONUS_SPACE_CCF,     /**< The Allen CCFv3: AP, DV, ML, micrometres from the corner of its grid; needs a frame.   */
    CONUS_SPACE_BREGMA   /**< AP, ML, DV, mm from bregma, + anterior, right, dorsal; needs a frame, too.             */
} conus_space;

/** Where a space lies in the world of an atlas. */
typedef struct conus_frame {
    conus_space space;           /**< Which space it is. */
    double world_from_space[16]; /**< Column-major affine; maps the space's numbers to world mm. */
    double bregma[3]; /**< For #CONUS_SPACE_CCF and #CONUS_SPACE_BREGMA: where bregma lies in CCF, AP, DV, ML,
                         micrometres. */
} conus_frame;

/** Finds where a space lies in the world of an atlas. An atlas is known to be the Allen CCF by its grid of 13.2 x 8 x
 * 11.4 mm, by the name allen_mouse in BrainGlobe's metadata.json, or by the key "ccf" of its manifest.
 * @param[out] out The frame.
 * @param atlas The atlas; NULL is allowed for #CONUS_SPACE_RAS and #CONUS_SPACE_LPS.
 * @param space Which space.
 * @param bregma Where bregma lies, in CCF: AP, DV, ML, micrometres; NULL = 5400, 332, 5739.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an unknown space, and for a bregma outside of the CCF;
 * #CONUS_ERROR_UNSUPPORTED for an atlas that is not known to be the CCF. */
CONUS_CHECKED conus_status conus_frame_find(conus_frame *out, const conus_atlas *atlas, conus_space space,
                                            const double bregma[3]);

/** Takes a position to the world.
 * @param[out] world World mm.
 * @param frame The frame.
 * @param point In the order and unit of the frame's space. May be @p world.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a number that is not finite, and for a position in CCF or from bregma
 * that must be in another unit: all three within 20 um of the CCF's corner, or one of them over 100 mm from bregma. */
CONUS_CHECKED conus_status conus_frame_to_world(double world[3], const conus_frame *frame, const double point[3]);

/** Takes a position in the world to the space.
 * @param[out] point In the order and unit of the frame's space.
 * @param frame The frame.
 * @param world World mm. May be @p point. */
CONUS_API void conus_frame_from_world(double point[3], const conus_frame *frame, const double world[3]);

/** Takes a direction to the world.
 * @param[out] world Of any length.
 * @param frame The frame.
 * @param direction In the order of the frame's space, of any length. May be @p world. */
CONUS_API void conus_frame_direction_to_world(double world[3], const conus_frame *frame, const double direction[3]);

/** Takes a direction in the world to the space.
 * @param[out] direction In the order of the frame's space, of the length 1.
 * @param frame The frame.
 * @param world Of any length but 0. May be @p direction. */
CONUS_API void conus_frame_direction_from_world(double direction[3], const conus_frame *frame, const double world[3]);

#ifdef __cplusplus
}
#endif

#endif
