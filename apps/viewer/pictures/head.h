/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The tracked head of who looks at the screen: where its eye is, and what it sees through a part of the screen
 * (Eq. 1). What was seen last stays until a head is seen again. World RAS+, mm. */
#ifndef CONUS_VIEWER_MODEL_HEAD_H
#define CONUS_VIEWER_MODEL_HEAD_H

#include "link/station.h"
#include "viewer/pictures/sight.h"

struct head {
    bool named;               /**< A tool is on it: --head.                                       */
    bool on;                  /**< The 3-D pane shows what it sees.                               */
    bool known;               /**< The eye below is one.                                          */
    bool inside;              /**< The newest eye was in the screen's plane or behind, and is not the one below. */
    enum station_state state; /**< Of the tool.                                                   */
    double eye[3];
    conus_pose screen; /**< Its middle, +x to its right, +y up, +z to the viewer.          */
    double size[2];    /**< Of the screen, width and height; 0, 0 = not known.           */
    unsigned number;   /**< Grows with every change that shows.                            */
};

/** The eye and the screen are there now. */
void head_move(struct head *head, const double eye[3], const conus_pose *screen);
/** The tool is as @p state says. */
void head_set_state(struct head *head, enum station_state state);
/** Shows what it sees, or again what the mouse turns. False: there is no head. */
bool head_toggle(struct head *head);

/** What it sees through a part of the screen: left, right, lower and upper edge, each from 0 to 1 of the whole. False
 * where that is not shown, or never was seen. */
bool head_sight(struct sight *out, const struct head *head, const double part[4]);
/** One line about it; *is_well tells whether the head is seen. NULL where it does not matter. */
const char *head_text(const struct head *head, bool *is_well);

#endif
