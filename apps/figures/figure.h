/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options of conus render and the window's figures about the sheet: size, side, background, legend, letters. */
#ifndef CONUS_FIGURES_FIGURE_H
#define CONUS_FIGURES_FIGURE_H

#include "options/options.h"

#include "conus/picture.h"

struct figure_settings {
    uint32_t size[2];
    double width_mm, height_mm, dpi; /* 0 = not given */
    size_t side, legend;             /* 0 or conus_side + 1, conus_legend */
    size_t style;
    const char *background;
    bool safe_colours, no_legend;
    const char *palette, *unselected;
    uint32_t legend_rows;          /**< 0 = not given. */
    const char *streamline_colour; /**< As in conus_renderer_options. */
};

/** Names of conus_legend, in its order, then NULL. */
extern const char *const figure_legends[];

extern const struct option figure_options[];

/** Whether the options go together, and the background is one; prints an error if not. */
bool figure_check(const struct figure_settings *settings);

/** Sets what of @p view these options are about; they have been checked. */
void figure_view(conus_view *view, const struct figure_settings *settings);

/** Gives the atlas the colours that the options say. Returns the exit code and prints an error unless it is 0. */
int figure_colour_atlas(conus_atlas *atlas, const struct figure_settings *settings);

#endif
