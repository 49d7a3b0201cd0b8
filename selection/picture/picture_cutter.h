/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A cut's view, as the picture of a cut and the figure around it read it. */
#ifndef CONUS_SELECTION_PICTURE_PICTURE_CUTTER_H
#define CONUS_SELECTION_PICTURE_PICTURE_CUTTER_H

#include "base/status.h"
#include "conus/own.h"
#include "render/flat/cut.h"

/** CONUS_ERROR_ARGUMENT for a width or height that no cut has. */
conus_status cut_view_check_size(const conus_cut_view *view);

/** The axes of the picture; those of an axial cut unless the caller chose some. */
void cut_view_axes(double right[3], double up[3], const conus_cut_view *view);

/** The cone or cylinder of a selection, which must outlive @p out. */
void cutter_cone(struct cut_cone *out, const conus_selection *selection);

/** Without a cone, or colours that somebody chose, pathways and bundles stand out from areas: they have their own
 * colours, and areas that are not in @p listed, which may be NULL, are a neutral grey.
 * @param[out] out [objects + 1] What stands out, to be freed; NULL where there is a cone, colours were chosen, or
 * neither pathways nor bundles are shown.
 * @return CONUS_OK or CONUS_ERROR_MEMORY. */
conus_status cutter_list_tracts(bool **out, const conus_atlas *atlas, const conus_selection *selection,
                                bool own_colours, const bool *listed);

/** What the figure around a cut says about the answer. */
struct cutter_figure {
    cut_line *line; /**< Gets the lines of surfaces, which are then not drawn. */
    void *line_user;
    const uint32_t *ranks;   /**< [objects + 1] NULL = picture_ranks().                          */
    const uint8_t *emphasis; /**< [objects + 1] NULL = picture_emphasis(). */
    const bool *listed;      /**< [objects + 1] What has its own colour unless it has a rank; NULL = nothing. */
    bool has_cone;           /**< It is drawn. */
};

/** Draws what conus_cutter_draw() does, as the figure says. @p out is the cutter's. */
conus_status cutter_draw_figure(const struct cut **out, conus_cutter *cutter, const conus_cut_view *view,
                                const struct cutter_figure *figure);

#endif
