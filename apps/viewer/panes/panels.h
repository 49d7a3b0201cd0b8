/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The panels around the panes: widgets only, each drawn by one call per frame. */
#ifndef CONUS_VIEWER_PANES_PANELS_H
#define CONUS_VIEWER_PANES_PANELS_H

#include "viewer/commands/keys.h"
#include "viewer/model/plans.h"

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
void panel_card(struct window *window);       /**< Facts about the chosen area, and actions on it. */
void panel_study_kind(struct viewer *viewer); /**< The choice of a study. */
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
