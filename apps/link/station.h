/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A connection to a tracking station or to 3D Slicer by OpenIGTLink, on a thread of its own: the newest pose of each
 * tool is there to be asked for, whatever arrives and however fast, and what was selected goes back. */
#ifndef CONUS_LINK_STATION_H
#define CONUS_LINK_STATION_H

#include "link/igtl.h"

#include "conus/pose.h"

enum { STATION_PORT = 18944 };

struct station;

struct station_options {
    const char *host;   /**< Connect to it; NULL = wait to be connected to.                                  */
    const char *listen; /**< Address to wait on; NULL = 127.0.0.1: no other machine.                         */
    uint16_t port; /**< Port of a host, 0 = STATION_PORT; port to wait on, 0 = one that is free.                    */
    const char *tool;      /**< Name of the tool that points; NULL = the first that comes.      */
    const char *second;    /**< Name of a second tool that points; NULL = none.                              */
    const char *reference; /**< Poses are taken in this tool's frame, the subject's head, say; NULL = as they come. */
    double world_from_tracker[16]; /**< Column-major, rigid; all 0 = the identity.                              */
    double enlarged;  /**< The brain is shown so many times as large as it is, about the world's origin (Eq. 1: s); 0
                         = 1. */
    const char *head; /**< The tool on the head of who looks at a screen; NULL = none. It never points.            */
    double eye[3];    /**< In that tool's frame, mm.                                                            */
    double tracker_from_screen[16]; /**< The screen's middle, +x to its right, +y up, +z to the viewer, in the sender's
                                         frame; column-major, rigid; all 0 = the identity.                      */
    bool lps;        /**< The sender's frame is LPS, not RAS.                                             */
    conus_axis axis; /**< The tool's axis along which it points; CONUS_AXIS_OF_FORMAT = -z.                     */
};

enum station_state {
    STATION_WAITING = 0, /**< Nobody is connected.                                    */
    STATION_SILENT,      /**< Connected, but no pose of the tool yet.                 */
    STATION_LOST,        /**< The sender does not see the tool, or the reference.     */
    STATION_STALE,       /**< No pose for half a second.                              */
    STATION_SEEN
};

/** Who looks at what. */
struct station_head {
    enum station_state state;
    double eye[3];     /**< In the world, where state is STATION_SEEN. */
    conus_pose screen; /**< Likewise; it moves with the reference.    */
};

/** Where a second tool is. */
struct station_tool {
    enum station_state state;
    conus_pose pose; /**< Pose of the device in the world, where state is STATION_SEEN.   */
    uint64_t number; /**< Number of this pose, from 1; 0 = none yet. */
};

/** The state of things. */
struct station_update {
    enum station_state state;
    conus_pose pose; /**< Pose of the device in the world, where state is STATION_SEEN.   */
    uint64_t number; /**< Number of this pose, from 1: tells a new one from the same again. */
    double age_s;    /**< Since it arrived.                                          */
    double time_s;   /**< The sender's clock.                                        */
    struct station_head head;
    struct station_tool second;
    struct igtl_counts counts;
    uint64_t dropped;    /**< Connections that were closed for what they sent.           */
    const char *trouble; /**< Why the last try to connect failed, static; NULL = none has. */
    unsigned clients;
};

/** Starts a station. Where that fails, returns false, and @p why says why in one line. Strings are copied. */
bool station_start(struct station **out, const struct station_options *options, char *why, size_t size);
void station_stop(struct station *station); /**< NULL is fine. */
/** Has @p call called, on the station's thread, after each pose of a tool that arrives: the one that
 * points, the reference, the head. */
void station_on_pose(struct station *station, void (*call)(void));

void station_ask(struct station *station, struct station_update *out);
/** Waits up to @p seconds for a pose that is newer than number @p after; false: there was none. */
bool station_wait(struct station *station, uint64_t after, double seconds, struct station_update *out);
/** Sends what was selected to all: a STRING of JSON and a POINT per contact. A later one replaces one not yet sent. */
void station_send(struct station *station, const char *json, const struct igtl_point *points, size_t count);
/** The port on which the station listens, once it does. */
uint16_t station_port(struct station *station);
/** The host that it connects to; NULL = it listens. */
const char *station_host(const struct station *station);

#endif
