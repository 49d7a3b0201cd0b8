/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What is said, and what stays chosen, where the atlas that is open is opened again with other files added. */
#ifndef CONUS_VIEWER_ADDED_H
#define CONUS_VIEWER_ADDED_H

#include "viewer/window/window.h"

#include <jansson.h>

/** The first note of @p after that @p before has not, and that begins so; NULL = there is none. */
const char *added_note(const conus_atlas *before, const conus_atlas *after, const char *start);
/** "added: b.trk; taken out: a.trk", or why it was opened again: the files of @p now that @p then has not, and the
 * other way round. Both are as window_words() gives them. */
void added_news(char *out, size_t size, const json_t *then, const json_t *now);
/** Chooses in each atlas what is chosen in that of @p before, and searches the same; both are of the same atlases. */
void added_choose(struct viewer *viewer, const struct viewer *before);

#endif
