/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The four pictures of the window: three cuts and the 3-D view, each drawn by one call per frame. */
#ifndef CONUS_VIEWER_PANES_PANES_H
#define CONUS_VIEWER_PANES_PANES_H

#include "viewer/panes/strokes.h"
#include "viewer/window/window.h"

void pane_cut(struct window *window, enum plane plane);
/** The borders of panes and panels, which the mouse drags; to be drawn before these. */
void pane_borders(struct window *window);
void pane_3d(struct window *window);
/** The chosen area, and those of a plan, over the picture of the 3-D pane, whatever lies before them. */
void pane_chosen(struct window *window);
void pane_chosen_names(struct window *window); /**< And their names. */
enum { PANE_NAME = 512 /**< Bytes of a name in a pane, in which it ends with "..." where it is too long. */ };
/** A name in a pane. */
struct pane_name {
    const char *name;
    uint32_t object; /**< Whose name it is; 0 = of none. */
    ui_colour colour;
    ui_colour chip; /**< The colour of its area, before it, since it need not lie on that; opacity 0 = none. */
    bool above;     /**< Above the place, not beside it. */
    bool is_hidden; /**< The camera does not see the place: the line is dashed, and the name pale. */
    float scale;    /**< The window's. */
};
/** Draws it where it lies on no other, with a line from there to the place. */
void pane_name(struct labels *labels, const struct ui_box *box, const float at[2], const struct pane_name *what);
/** A flat pane: where it is, and where it looks. */
struct pane_plane {
    struct ui_box box;
    conus_cut_view view;
};
/** The line between the two places that are measured, at these pixels, with its length. In a cut, @p plane, it is firm
 * where it lies in it, and only then has a length: that in 3-D, which it says unless all of it lies there. */
void pane_measured(const struct window *window, struct labels *labels, const struct ui_box *box,
                   const struct pane_plane *plane, float ends[2][2]);
/** The pixel of the window that a place is seen at, wherever it lies before or behind the cut. */
void pane_point(float out[2], const struct pane_plane *plane, const double world[3]);
void pane_normal(double out[3], const struct pane_plane *plane); /**< Of the cut, towards its viewer. */
/** A line as it is seen from before a cut: firm where it is in it, half a slice or @p radius away at most, else thin,
 * the fainter the farther away. Returns how much of it is firm, 0 to 1. */
double pane_line_cut(const struct window *window, const struct pane_plane *plane, const double from[3],
                     const double to[3], double radius, struct pen pen);
/** Whether a place is in a cut, likewise. */
bool pane_is_in_cut(const struct window *window, const struct pane_plane *plane, const double place[3], double radius);
/** The list of points over a pane, PANE_3D, or one with a cut; and the choice of one whose ball is at this pixel, false
 * where there is none. */
void pane_points(struct window *window, size_t pane, const struct ui_box *box, const struct pane_plane *plane);
bool pane_points_choose(struct window *window, const float at[2], const struct pane_plane *plane);
/** The cones of both tools, over a cut and over the 3-D pane. */
void pane_cones_cut(struct window *window, const struct pane_plane *plane);
void pane_cones(struct window *window);
/** The crosshair over the 3-D pane. */
void pane_cross(struct window *window);
/** Whether a tool has a cone that is drawn, and the pen of its lines. */
bool pane_tool_shows(const struct window *window, enum tool_number number);
struct pen pane_tool_pen(const struct window *window, enum tool_number number);
/** Finds the place of a tool's ball: as far out as it reaches, or as the pane shows it. */
void pane_ball_place(struct window *window, enum tool_number number);
void pane_ball_draw(struct window *window, enum tool_number number);
/** The tool whose ball is at this pixel of the 3-D pane; TOOL_COUNT = none. */
enum tool_number pane_cone_at(const struct window *window, const float at[2]);
/** Lets the mouse, which is on the 3-D pane's surface, turn the cone whose ball it took. Returns whether it has one. */
bool pane_cone_turn(struct window *window);

#endif
