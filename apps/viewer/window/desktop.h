/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The desktop's own settings. */
#ifndef CONUS_VIEWER_WINDOW_DESKTOP_H
#define CONUS_VIEWER_WINDOW_DESKTOP_H

#include "viewer/ui/theme.h"

/** The theme that the user chose for the desktop; the dark one where no desktop answers within a second. */
enum theme desktop_theme(void);

#endif
