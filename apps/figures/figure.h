/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Options of conus render and the window's figures about the sheet: size, side, background, legend, letters. */
#ifndef CONUS_FIGURES_FIGURE_H
#define CONUS_FIGURES_FIGURE_H

#include "conus/picture.h"
#include "conus/pose.h"
#include "options/options.h"

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

extern const struct option figure_options[];

/** Whether the options go together, and the background is one; prints an error if not. */
bool figure_check(const struct figure_settings *settings);

/** Sets what of @p view these options are about; they have been checked. */
void figure_view(conus_view *view, const struct figure_settings *settings);

/** Gives the atlas the colours that the options say. Returns the exit code and prints an error unless it is 0. */
int figure_colour_atlas(conus_atlas *atlas, const struct figure_settings *settings);

/* Rows of a list as points of a picture, among them contacts of electrodes, told by their names: LA1, LA2, ... */

/** Gives contacts their electrodes as groups, "LA" to "LA12", "LA-12" and "LA 12", if all names, which are not NULL,
 * are those of contacts: a word and a number behind it, three or more for each word on average. Then @p grouped is
 * true, and contacts_ungroup() ends it. False without memory. */
bool contacts_group(bool *grouped, conus_drawn_point *points, size_t count);
void contacts_ungroup(conus_drawn_point *points, size_t count);

/** The ball of a row without an error, with a line to what it points at; hollow where that is nothing. @p selector
 * finds that, and its range becomes the row's; of a point it is not used. @p radius is that of rows without one. What
 * is in it is the row's. */
conus_status contacts_place(conus_drawn_point *out, const conus_pose_row *row, double radius, conus_selector *selector);

#endif
