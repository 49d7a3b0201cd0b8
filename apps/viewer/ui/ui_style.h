/* SPDX-License-Identifier: BSD-3-Clause */
#include <stdbool.h>

/** @file How widgets look. */
#ifndef CONUS_VIEWER_UI_UI_STYLE_H
#define CONUS_VIEWER_UI_UI_STYLE_H

/** Loads the font for @p scale and sets sizes and colours, of which those under texts are the theme's. False where
 * there is no font. */
bool ui_style(float scale);

#endif
