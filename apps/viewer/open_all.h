/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Opens an atlas with what is added to it, and adds to the one that is open. */
#ifndef CONUS_VIEWER_OPEN_ALL_H
#define CONUS_VIEWER_OPEN_ALL_H

#include "viewer/loader.h"
#include "viewer/view_settings.h"
#include "viewer/window/window.h"

/** Opens the atlas that is open again, with the options @p words in place of its own; all that the user set stays.
 * False: the window stays as it was, and @p why says why; else that says what is other than before. */
bool open_again(struct window *window, const json_t *words, const struct view_settings *settings, char why[LOADER_WHY]);
/** Opens the files of @p wanted, in any order: an atlas or a session in place of what is open, tractograms and an image
 * as context in addition to it. Likewise; where the atlas is opened and the others cannot be added, that stays. */
bool open_all(struct window *window, const struct wanted *wanted, const struct view_settings *settings,
              bool with_options, char why[LOADER_WHY]);

#endif
