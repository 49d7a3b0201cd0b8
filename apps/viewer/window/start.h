/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the start page offers: atlases that were opened lately, those of this computer, and a path to type. */
#ifndef CONUS_VIEWER_WINDOW_START_H
#define CONUS_VIEWER_WINDOW_START_H

#include "viewer/window/recent.h"

enum { START_WHY = 512 };

struct start {
    bool on;         /**< The window shows it, as it does as long as there is no atlas. */
    bool takes_keys; /**< From the next frame on what is typed goes into the path. */
    char typed[PATH_MAX];
    char why[START_WHY]; /**< Why the last one was not opened, plain; "" = there is nothing to say. */
    struct recent recent;
    char found[PATH_MAX]; /**< An atlas of this computer that is not among the recent ones; "" = none. */
};

/** Fills the lists anew. */
void start_look(struct start *start);
/** Path @p index of the lists, the recent ones first; NULL past the last. */
const char *start_path(const struct start *start, size_t index);
/** Path @p index without what may not be shown, and where its last name begins in it. */
const char *start_words(char words[PATH_MAX], const struct start *start, size_t index);
/** The path that was typed, where ~ is the home folder; false where there is none, or it is too long. */
bool start_typed(char path[PATH_MAX], const struct start *start);

#endif
