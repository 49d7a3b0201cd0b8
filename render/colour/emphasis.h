/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How an object stands out in a picture with a cone. */
#ifndef CONUS_RENDER_COLOUR_EMPHASIS_H
#define CONUS_RENDER_COLOUR_EMPHASIS_H

enum emphasis {
    EMPHASIS_PALE = 0, /**< Not in the cone.                               */
    EMPHASIS_FULL,     /**< A pixel hits it first.                         */
    EMPHASIS_HATCHED,  /**< In the cone, but occluded: stripes of its colour. */
    EMPHASIS_GLASS,    /**< A surface around the areas: with a dark outline. */
};

#endif
