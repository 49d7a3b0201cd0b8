/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Opens the atlases that are open again with other options: other hemispheres, files added or taken out. */
#ifndef CONUS_VIEWER_OPENING_REOPEN_H
#define CONUS_VIEWER_OPENING_REOPEN_H

#include "viewer/opening/loader.h"
#include "viewer/opening/view_words.h"
#include "viewer/window/window.h"
#include <jansson.h>

/** Opens the same atlases with the options @p words in place of their own; undo goes @p step (0 = not at all). @p
 * settings are those of conus-view. All that the user set stays (replace.h). False: the window stays as it was; @p why
 * and stderr say why, unless the user cancelled. True: @p why says what is different now. */
bool reopen(struct window *window, const json_t *words, int step, const struct view_settings *settings,
            char why[LOADER_WHY]);

#endif
