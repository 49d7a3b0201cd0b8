/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What moves the two tools, and what the window says of a tool. */
#ifndef CONUS_VIEWER_TOOLS_TOOLS_H
#define CONUS_VIEWER_TOOLS_TOOLS_H

#include "conus/pose.h"
#include "link/station.h"
#include "viewer/devices/devices.h"
#include "viewer/model/viewer.h"

#include <stddef.h>

/* The inputs that move the two tools and a head: the mouse, trackers, devices, a file of poses. */

/** A file of poses on the time line. */
struct replay {
    conus_pose_list *poses; /**< NULL = none; only rows without errors are shown. */
    size_t at;
    bool playing;
    double started; /**< Clock, s, at which the row `from` was shown. */
    size_t from;
};

/** Shows row @p index of the replay. */
void replay_show(struct replay *replay, struct viewer *viewer, size_t index);
/** Seconds from the first row to row @p index: its time_s, or 0.1 s a row where the file has none. */
double replay_time(const struct replay *replay, size_t index);
/** Starts or stops the replay; @p clock in s. */
void replay_toggle(struct replay *replay, double clock);
/** Shows the row that the clock has come to. Returns whether the replay plays. */
bool replay_step(struct replay *replay, struct viewer *viewer, double clock);

/** Seconds until the replay shows another row; INFINITY while it does not play. */
double replay_idle_s(const struct replay *replay, const struct viewer *viewer, double clock);

enum { TRACKER_ADDRESS = 256 };

struct inputs {
    struct replay replay;
    struct station *station; /**< NULL = none. */
    struct station_update update;
    struct igtl_counts seen;              /**< Those of the update with the tool's newest pose. */
    const struct station_settings *asked; /**< The options of trackers that conus was started with; NULL = none. */
    char address[TRACKER_ADDRESS];        /**< The station that inputs_connect() starts, as --connect has it. */
    struct station *second_station;       /**< For the second tool; NULL = the first one's. */
    bool has_second_tool;                 /**< The first one's station takes its poses. */
    struct devices devices;
};

/** Connects to the tracker at the address, which moves the first tool then, as all options but --listen say; tries
 * again until it answers. @p wake (NULL = none) is called at each of its poses, on another thread. False: error_line()
 * says why not. */
bool inputs_connect(struct inputs *inputs, void (*wake)(void));
/** Ends the connection of the first tool's tracker, if there is one; a tracked head is not seen then. */
void inputs_disconnect(struct inputs *inputs, struct viewer *viewer);
/** Whether a tool's cone is one from before: its device does not say where it is. */
/** Confirms the best hit of a tool, as tool_confirm(), but none of an answer that is old. */
void inputs_confirm(const struct inputs *inputs, struct viewer *viewer, enum tool_number number);
bool inputs_is_old(const struct inputs *inputs, const struct viewer *viewer, enum tool_number number);

/** Asks the stations and every device that moves a tool what is new, moves the tools and the tracked head, and brings
 * the second tool's answers up to date. Returns whether the first tool got another pose. */
bool inputs_step(struct inputs *inputs, struct viewer *viewer, double now_s);
/** Seconds until devices that cannot wake the window are to be asked again; INFINITY where none moves a tool. */
double inputs_idle_s(const struct inputs *inputs, const struct viewer *viewer);
/** Lets the mouse point along a ray from the eye (point.c) with the tool that it moves. */
void inputs_point(struct inputs *inputs, struct viewer *viewer, const double eye[3], const double direction[3]);

/** Moves and turns a tool along its own axes; a tool without a pose is placed instead. */
void inputs_steer(struct viewer *viewer, enum tool_number number, const double move[3], const double turn[3]);

/** A message about a tool: it is held, it is not there yet, or its tracker is gone. */
struct notice {
    const char *text; /**< One line; NULL = there is nothing to say. */
    bool is_trouble;  /**< The cone is not, or no longer, where its tool is. */
    bool is_old;      /**< So the answer is one from before. */
};
void inputs_notice(struct notice *out, const struct inputs *inputs, const struct viewer *viewer,
                   enum tool_number number);

/* The pose of a ray through the mouse: where the cone's apex is. World RAS+, mm. */

/** How far it is from @p from along the unit vector @p direction to the surface of what is shown: to the context of the
 * drawn atlas, a head's skin, or to the first object of any atlas, whichever is nearer. INFINITY beside them. */
double point_depth(struct viewer *viewer, const double from[3], const double direction[3]);

/** The pose that the mouse gives by a ray from the eye that goes through it: from the surface, or from the eye itself
 * where the cone has its apex there. False where the ray passes beside all surfaces. */
bool point_find(conus_pose *out, struct viewer *viewer, const double eye[3], const double direction[3]);

/** How far before the surface the mouse's cone begins, mm, where it does so: 40, or half the radius of a small atlas. A
 * cone whose range has an end begins on the surface then: its depths count from there. */
double point_before(const struct viewer *viewer);
/** Where it does begin. */
enum starts point_start(const struct viewer *viewer);

/* How far a tool's cone reaches, and how it is turned about the place where it comes into the brain. World RAS+, mm. */

struct extent {
    double entry[3]; /**< Where the axis, from far before the apex, comes into what is shown (point.c); beside that its
                          place that is nearest to the middle. */
    double reach;    /**< Its ball is so far before the entry, or nearer where that is not seen: 40, or half the radius
                          of a small atlas; beside what is shown outside of all. */
    double near;     /**< Depths along the axis from the apex: the cone begins, */
    double first;    /**< has its nearest hit, else it ends there, */
    double solid;    /**< has its deepest hit, where only first hits count, else it ends there, */
    double end;      /**< and ends: its range does, or else its axis leaves what is shown, with all layers all rays. */
};

/** Finds it for a tool that has a pose. */
void extent_find(struct extent *out, struct viewer *viewer, enum tool_number number);

/** Where the ball is. */
void extent_ball(double out[3], const struct extent *extent, const conus_pose *pose);

/** Turns a tool about the entry, so that its ball is seen along the ray from @p eye along the unit vector @p direction,
 * on the side on which it is; beside all such places as near to the ray as it can be. */
void extent_turn(struct viewer *viewer, enum tool_number number, const struct extent *extent, const double eye[3],
                 const double direction[3]);

/* The wall of a cone, a range of one or a cylinder, between two rings of points, drawn as lines. World, mm. */

enum { SHELL_POINTS = 64 };

struct shell {
    double near[SHELL_POINTS][3],
        far[SHELL_POINTS][3];    /**< Each near point and its far point are on one line of the wall. */
    double out[SHELL_POINTS][3]; /**< Unit normals of the wall there. */
};

/** Finds the wall at @p pose between two depths along the axis: @p radius at the apex, 0 of a cone, and the full
 * opening
 * @p angle, degrees, 0 of a cylinder. */
void shell_find(struct shell *out, const conus_pose *pose, double radius, double angle, double near, double far);

/** A straight piece of the wall in a plane. */
struct shell_piece {
    double ends[2][3];
};

/** Where the plane through @p at with the unit normal @p normal cuts the wall; returns how many pieces that are. */
size_t shell_cut(struct shell_piece out[2 * SHELL_POINTS], const struct shell *shell, const double at[3],
                 const double normal[3]);

/** Whether the wall is seen from the side by @p eye between points @p i and i + 1: there is its outline. */
bool shell_turns(const struct shell *shell, size_t i, const double eye[3]);

#endif
