/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The search for areas and pathways of an atlas by what a user types. Names come before numbers. */
#ifndef CONUS_VIEWER_MODEL_SEARCH_H
#define CONUS_VIEWER_MODEL_SEARCH_H

#include "conus/atlas.h"

/** How well an object fits a text, the case of ASCII letters aside: by its name or its abbreviation, and last by its
 * label. A word begins where a letter or digit follows something else. Nothing fits an empty text. */
enum search_fit {
    SEARCH_NONE = 0,
    SEARCH_LABEL,  /**< The label is the text. */
    SEARCH_PART,   /**< The text is in the name. */
    SEARCH_WORD,   /**< A word of the name begins with it. */
    SEARCH_BEGIN,  /**< The name begins with it. */
    SEARCH_EXACT,  /**< The name is the text, but for the case, */
    SEARCH_SAME,   /**< or in every byte. */
    SEARCH_FIT_END /**< How many there are. */
};

enum search_fit search_fit(const conus_object *object, const char *text);

/** Numbers of the objects of @p atlas that fit, best first, and by number where they fit alike. To be freed; @p
 * count is how many. NULL without memory. */
uint32_t *search_all(size_t *count, const conus_atlas *atlas, const char *text);

/** The best of them; 0 = none, or no memory. */
uint32_t search_best(const conus_atlas *atlas, const char *text);

#endif
