/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What is said where the atlas that is open is opened again: what is other than before. */
#ifndef CONUS_VIEWER_OPENING_NEWS_H
#define CONUS_VIEWER_OPENING_NEWS_H

#include "viewer/window/window.h"

#include <jansson.h>

/** Whether @p word is among @p words, as window_words() gives them. */
bool news_has_word(const json_t *words, const json_t *word);
/** The first note of @p after that @p before has not, and that begins so; NULL = there is none. */
const char *news_note(const conus_atlas *before, const conus_atlas *after, const char *start);
/** "added: b.trk; taken out: a.trk; ...": the files of the options @p words that the first atlas of the window was not
 * opened with, and the other way round, how hemispheres are if they are others, and what @p now notes that it did not
 * note. */
void news_tell(char *out, size_t size, const struct window *window, const conus_atlas *now, const json_t *words);

#endif
