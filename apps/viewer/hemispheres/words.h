/* SPDX-License-Identifier: BSD-3-Clause */
/** @file --hemispheres among the words of options that a session keeps (viewer/view_words.h). */
#ifndef CONUS_VIEWER_HEMISPHERES_WORDS_H
#define CONUS_VIEWER_HEMISPHERES_WORDS_H

#include <conus/conus.h>

#include <jansson.h>

/** What they say of it; NULL is no words. */
conus_hemispheres hemispheres_of_words(const json_t *words);
/** Makes them say this; false without memory. */
bool hemispheres_put_in_words(json_t *words, conus_hemispheres how);

#endif
