/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a flat pane, or a figure of one, shows. */
#ifndef CONUS_VIEWER_MODEL_CUT_VIEW_H
#define CONUS_VIEWER_MODEL_CUT_VIEW_H

#include "viewer/model/viewer.h"

/** The cut through the crosshair in a picture of @p size pixels: at magnification 1 the atlas fills its shorter side.
 */
void cut_view(conus_cut_view *out, const struct viewer *viewer, enum plane plane, const double size[2]);

#endif
