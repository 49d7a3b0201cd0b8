/* SPDX-License-Identifier: BSD-3-Clause */
/** @file --hemispheres among the words of options that a session keeps (viewer/opening/view_words.h). */
#ifndef CONUS_VIEWER_MODEL_HEMISPHERE_WORDS_H
#define CONUS_VIEWER_MODEL_HEMISPHERE_WORDS_H

#include <conus/conus.h>

#include <jansson.h>

enum { HEMISPHERES_COUNT = CONUS_HEMISPHERES_MERGED + 1 };
/** What each means, for people. */
extern const char *const hemispheres_meanings[HEMISPHERES_COUNT];

/** What they say of it; NULL is no words. */
conus_hemispheres hemispheres_of_words(const json_t *words);
/** A copy of them that says this; NULL without memory. */
json_t *hemispheres_put_in_words(const json_t *words, conus_hemispheres how);

#endif
