/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The two tools of the window. The same functions move, hold and confirm both. All atlases of the viewer are asked what
 * a tool's cone hits; the questions about the two tools differ only in pose and angle. World RAS+, mm. */
#ifndef CONUS_VIEWER_MODEL_TOOL_H
#define CONUS_VIEWER_MODEL_TOOL_H

#include "conus/pose.h"

#include <stdint.h>

struct viewer;

enum pointer {
    POINT_BY_MOUSE = 0,
    POINT_BY_WAND,
    POINT_BY_REPLAY,
    POINT_BY_TRACKER,
    POINT_BY_SPACEMOUSE,
    POINT_BY_GAMEPAD,
    POINTER_COUNT
};
/** The names of pointers in panels, scripts and messages. */
extern const char *const pointer_names[POINTER_COUNT];

enum tool_number { FIRST_TOOL = 0, SECOND_TOOL, TOOL_COUNT };

struct tool {
    bool on;              /**< The first one is always; the second one is off at first. */
    enum pointer pointer; /**< It moves the tool: only a tracker moves both tools. The second one never a replay. */
    conus_pose pose;
    bool has_pose, held; /**< Held: neither mouse nor device moves it. */
    bool is_point;       /**< Of the pose only the place counts: what is there, or in a ball of the cylinder's radius,
                            is the answer. Only of the first tool. */
    double angle;        /**< Full opening, degrees. */
    unsigned answer_number; /**< Tells answers apart, whose addresses may come again. */
    double select_ms;       /**< For all atlases. */
    /* of the second tool, which is asked when its answer is needed: */
    unsigned version;     /**< Grows with every change that shows; the viewer's does not: its cuts stay as they are. */
    unsigned asked_after; /**< The first tool's answer_number when the second was asked: each change of the question
                             gives the first one a new number. */
    bool is_asked;        /**< Its answers belong to the present pose and angle. */
};

/** Asks again for the first tool. To be called after options, score, its angle, or whether it has a pose changed:
 * without a pose there is no answer. */
void tool_reselect(struct viewer *viewer);
/** Takes the first tool's pose and answer away; the mouse may give it another pose. */
void tool_clear(struct viewer *viewer);

/** To be called when its pose or angle was changed. */
void tool_changed(struct viewer *viewer, enum tool_number number);
/** Moves it, held or not. */
void tool_aim(struct viewer *viewer, enum tool_number number, const conus_pose *pose);
/** Puts the first tool where a pose is, of which only the place counts. */
void tool_aim_point(struct viewer *viewer, enum tool_number number, const conus_pose *pose);
/** A number for which objects the first tool's answer has in the drawn atlas, in which order, how strong their colours
 * are, and which of them are only behind others: what pictures show of it. */
uint64_t tool_answer_sum(const struct viewer *viewer);
/** Whether it has a cone: a pose, and not only a place. */
bool tool_has_cone(const struct viewer *viewer, enum tool_number number);
/** Aims it from @p origin along @p direction; where that is no direction, the status line says so. */
void tool_aim_along(struct viewer *viewer, enum tool_number number, const double origin[3], const double direction[3]);
/** Puts it where it is to start, looking at the brain's middle: the first before the face, the second to the right. */
void tool_place(struct viewer *viewer, enum tool_number number);
/** Holds it where it is, or lets it go; without a pose there is nothing to hold. */
void tool_hold(struct viewer *viewer, enum tool_number number);
/** Its angle times @p factor, from 0.1 to 179 degrees. */
void tool_widen(struct viewer *viewer, enum tool_number number, double factor);
/** Pins the best hit of its cone in the drawn atlas. */
void tool_confirm(struct viewer *viewer, enum tool_number number);
/** Has it moved by @p pointer from now on; then nothing holds it. */
void tool_choose(struct viewer *viewer, enum tool_number number, enum pointer pointer);
/** Has it moved by the next of all that can move it, and says so. */
void tool_choose_next(struct viewer *viewer, enum tool_number number);

/** Switches the second tool on or off; a pose stays. What moves the first tool does not move the second. */
void tool_use_second(struct viewer *viewer, bool on);
/** Whether the first tool has the device that shall move the second one. */
bool tool_second_is_taken(const struct viewer *viewer);
/** Asks the atlases about the second tool, if it is on and its answers are out of date. */
void tool_update_second(struct viewer *viewer);

/** Whether its pointer moves it: the second one only while it is on and the first has another pointer. */
bool tool_is_moved(const struct viewer *viewer, enum tool_number number);
/** The tool that @p pointer moves; TOOL_COUNT = none. */
enum tool_number tool_moved_by(const struct viewer *viewer, enum pointer pointer);

#endif
