/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What is drawn in the window's frame: the four panes, the panels around them, and lines over pictures. */
#ifndef CONUS_VIEWER_PANES_PANES_H
#define CONUS_VIEWER_PANES_PANES_H

#include "viewer/commands/commands.h"
#include "viewer/model/viewer.h"
#include "viewer/ui/ui.h"
#include "viewer/window/window.h"

/* Lines over pictures: each has a dark edge, so that it is seen on white as on black. Pixels of the window. */

struct pen {
    ui_colour colour;
    float width; /**< Without the edges, at scale 1. */
    float scale; /**< The window's. */
};

void stroke_line(const float from[2], const float to[2], struct pen pen);
/** Dashes; @p phase, 0 at first, goes on where several lines are one behind the other. */
void stroke_dashes(float *phase, const float from[2], const float to[2], struct pen pen);
/** A ring; @p radius at scale 1. */
void stroke_circle(const float centre[2], float radius, struct pen pen);

/* The four pictures of the window: three cuts and the 3-D view, each drawn by one call per frame. */

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

/* The panels around the panes: widgets only, each drawn by one call per frame. */

void panel_start(struct window *window);  /**< In place of all others. */
void panel_dialog(struct window *window); /**< Likewise. */
void panel_ask(struct window *window);    /**< Before all others: how files open, or whether all closes. */
void panel_areas(struct window *window);
/** How many areas are hidden, while some are, for the answer is without them. */
void panel_hidden(struct window *window);
/** What has to be known to read the answer. */
struct panel_warning {
    enum theme_text colour;
    char text[512];
    const char *more; /**< NULL = no more. */
};
/** Finds what holds from @p index on, which goes to behind it: of the names and places of the atlases, and what the
 * program warned of on stderr, as tables, sidecars and conus cite have it. False where nothing does. */
bool panel_warning(struct panel_warning *out, size_t *index, const struct viewer *viewer);
void panel_warnings(const struct viewer *viewer);
/** A folded panel, left (0) or right (1). */
void panel_rail(struct window *window, size_t side);
/** Lists of the hits of a tool, one for each atlas, in the order in which they were given, so many lines high together.
 */
void panel_lists(struct window *window, enum tool_number tool, float lines);
void panel_second(struct window *window);   /**< The second tool. */
void panel_question(struct window *window); /**< The settings that everybody needs, */
void panel_expert(struct window *window);   /**< and all others. */
void panel_look(struct window *window);     /**< How the atlas is drawn. */
void panel_views(struct window *window);    /**< Buttons over the 3-D pane. */
/** Their width and height, pixels, from the pane's upper left corner. */
void panel_views_size(float out[2], const struct window *window);
void panel_card(struct window *window); /**< Facts about the chosen area, and actions on it. */
/** Sweep or jitter of the cone; pale where @p is_old says that the cone is one from before. */
void panel_study(struct window *window, bool is_old);
static inline enum theme_text panel_verdict_colour(const struct plan_verdict *verdict) /**< The words say it, too. */
{
    static const enum theme_text colours[] = {THEME_HINT, THEME_GREEN, THEME_ORANGE, THEME_ORANGE};
    return colours[verdict->state];
}
/** The verdict of a plan's constraints on the first tool; nothing without a plan. */
void panel_plan(struct window *window);
void panel_planned(struct window *window); /**< The planned poses. */
void panel_points(struct window *window);  /**< The list of points. */
void panel_results(struct window *window);
/** The button that chooses the columns of the lists. */
void panel_columns(struct window *window);
/** Widgets of how an area looks. */
void panel_look_area(struct viewer *viewer, uint32_t object);
void panel_figure(struct window *window); /**< Before all others. */
void panel_added(struct window *window);  /**< Likewise: what was added to the atlas. */
/** How fast a SpaceMouse or a gamepad moves; nothing of another pointer. */
void panel_speed(struct window *window, enum pointer pointer);
void panel_status(struct window *window);
/** The widget of a property, as its row says, with a tip that names it and the keys that change it. */
void panel_property(struct window *window, enum property_id id);
/** A button that presses a key. */
void panel_key_button(struct window *window, const char *label, const char *key, const char *tip);
/** Hides an object or shows it, and hides all others, by small buttons in this line or large ones. */
void panel_hide(struct viewer *viewer, uint32_t object, bool small);
/** A line to search an area: Enter chooses what fits best. */
void panel_search(struct viewer *viewer, const char *label, const char *hint, const char *tip);
/** The colour of an object of the drawn atlas; grey of none. */
ui_colour panel_colour(const struct viewer *viewer, uint32_t object);
enum { PANEL_NAME = 118 /**< Pixels at scale 1: most names of human atlases. */ };
/** The widths of a table, the first of which is that of names; they hold in the first frame already. */
void panel_widths(float *out, const struct window *window, const char *const *headings, const char *const *widest,
                  size_t count);
/** A row of a page that can be clicked, and what follows stands in it. @p tip: NULL = none; height 0: a line's. */
bool panel_row(const struct window *window, size_t index, bool marked, const char *tip, float height);
/** The name of a plain path, and paler its folder. */
void panel_path(const char *path);
/** Begins a page in the middle of the window, and returns its width. */
float panel_page(const struct window *window, const char *title);
/** A key, and what it does on a page. */
void panel_key(const struct window *window, const char *key, const char *meaning);
/** A number at the right of its cell; "-" where it is none. */
void panel_number(const char *format, double value);

#endif
