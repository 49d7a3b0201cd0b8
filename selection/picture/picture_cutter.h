/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A cut's view, as the picture of a cut and the figure around it read it. */
#ifndef CONUS_SELECTION_PICTURE_PICTURE_CUTTER_H
#define CONUS_SELECTION_PICTURE_PICTURE_CUTTER_H

#include "base/status.h"
#include "conus/picture.h"
#include "render/flat/cut.h"

/** CONUS_ERROR_ARGUMENT for a width or height that no cut has. */
conus_status cut_view_check_size(const conus_cut_view *view);

/** The axes of the picture; those of an axial cut unless the caller chose some. */
void cut_view_axes(double right[3], double up[3], const conus_cut_view *view);

/** The cone or cylinder of a selection, which must outlive @p out. */
void cutter_cone(struct cut_cone *out, const conus_selection *selection);

/** Draws what conus_cutter_draw() does, without the cone, and gives the lines of surfaces to @p line with @p user; NULL
 * = they are drawn. @p out is the cutter's. */
conus_status cutter_draw_bare(const struct cut **out, conus_cutter *cutter, const conus_cut_view *view, cut_line *line,
                              void *user);

#endif
