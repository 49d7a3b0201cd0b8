/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The window's second tool: off at first. All atlases of the viewer are asked what its cone hits, as they are asked for
 * the first tool's, but with an angle of its own. World RAS+, mm. */
#ifndef CONUS_VIEWER_TOOLS_SECOND_H
#define CONUS_VIEWER_TOOLS_SECOND_H

#include "viewer/model/viewer.h"

/** sRGB of its cone. */
#define SECOND_RGB 0, 190, 255

/** All 0 is one that is off. */
struct second {
    bool on;
    enum pointer pointer; /**< What moves it: nothing moves both tools but the tracker. Never the replay. */
    conus_pose pose;
    bool has_pose, held;     /**< Held: nothing moves it. */
    double angle;            /**< Full opening, degrees; 0 = it was never set (second_angle()). */
    struct answer **answers; /**< [viewer's atlas_count] In each atlas; NULL, or of one NULL, = none. */
    size_t atlas_count;
    unsigned answer_number; /**< Tells answers apart. */
    unsigned asked_after;   /**< The viewer's number of its answer when they were asked for: whatever changes what is
                                 asked gives that another one. */
    bool is_asked;          /**< They are to the pose and angle that are now. */
    double select_ms;       /**< Of all atlases. */
    unsigned version; /**< Grows with every change that shows; the viewer's does not: its cuts stay as they are. */
};

/** There are no answers any more: the atlas that they are of goes, or the tool is off. */
void second_forget(struct second *second);

/** To be called when @p second was changed. */
void second_touch(struct second *second);
/** Full opening, degrees: 5 unless it was set. */
double second_angle(const struct second *second);
/** Switches it on or off; a pose stays. What moves the first tool does not move one that is switched on. */
void second_use(struct second *second, struct viewer *viewer, bool on);
/** Moves it, held or not. */
void second_aim(struct second *second, const conus_pose *pose);
/** Has the atlases asked if the answers are not those to what is set now; costs nothing otherwise, or while it is off.
 */
void second_update(struct second *second, struct viewer *viewer);

/** The answer in an atlas of the viewer, after second_update(); NULL = none. */
const conus_selection *second_selection(const struct second *second, size_t atlas);
/** Its full opening as it is asked, radians; 0 of a cylinder. */
double second_question(conus_selector_options *options, const struct second *second, const struct viewer *viewer,
                       size_t index);

#endif
