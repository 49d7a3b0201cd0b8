/* SPDX-License-Identifier: BSD-3-Clause */
/** @file OpenIGTLink: its messages, and a connection to a tracking station or to 3D Slicer. */
#ifndef CONUS_LINK_STATION_H
#define CONUS_LINK_STATION_H

#include "conus/pose.h"
#include "conus/selection.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* OpenIGTLink, the protocol of trackers and of 3D Slicer: poses of tools in, texts and points out. Header versions 1
 * and 2. Strict, as what comes over a network must be: sizes are checked before they are believed, and nothing but
 * poses is kept.
 *
 * Header, 58 bytes, big-endian: version u16, type char[12], device char[20], time u32.u32, body size u64, CRC64 of the
 * body u64 (ECMA-182). Version 2 bodies begin with an extended header of 12 bytes or more and end with metadata. */

enum {
    IGTL_HEADER = 58,
    IGTL_NAME = 21,              /**< Names of devices and tools, with the final NUL.                       */
    IGTL_TOOLS = 32,             /**< In one message; more are left out and counted.                       */
    IGTL_BODY_LIMIT = 64 * 1024, /**< For a message that is read.                                           */
    IGTL_SKIP_LIMIT = 64 << 20   /**< For a message of another kind, which is skipped.                  */
};

/** Where a tool is. */
struct igtl_pose {
    char name[IGTL_NAME];
    double matrix[16]; /**< Column-major, rigid, mm, in the sender's frame. */
    bool lost;         /**< The sender does not see the tool: it sent the identity.                */
};

/** The poses of tools in one message. */
struct igtl_poses {
    struct igtl_pose tools[IGTL_TOOLS];
    size_t count;
    double time_s; /**< The sender's clock, s since 1970; 0 if it has none. */
};

/** Counts of messages that were refused, by reason. */
struct igtl_counts {
    uint64_t messages; /**< Whole ones, of any kind.                            */
    uint64_t poses;
    uint64_t broken;   /**< Wrong checksum, or a body that does not fit its type. */
    uint64_t refused;  /**< Poses that are none: NaN, no rotation, mirrored.    */
    uint64_t mirrored; /**< Of these the mirrored ones. */
};

/** A stream of messages on its way in. A zeroed one is ready. */
struct igtl_reader {
    uint8_t bytes[IGTL_HEADER + IGTL_BODY_LIMIT];
    size_t size;    /**< Bytes of them in use.                                    */
    uint64_t skip;  /**< Bytes of a body that is passed over.              */
    uint64_t valid; /**< Messages that the last igtl_read() ended, of a kind that is read, as they should be. */
    struct igtl_counts counts;
};

/** Called for each message with poses. */
typedef void (*igtl_listener)(void *user, const struct igtl_poses *poses);

/** Reads @p size bytes. False where the stream is damaged (a version that is not 1 or 2, a body beyond
 * IGTL_SKIP_LIMIT); close the connection then. */
bool igtl_read(struct igtl_reader *reader, const uint8_t *bytes, size_t size, igtl_listener listener, void *user);

/** Writes messages of version 1 to @p out; gives their size, or 0 where they do not fit into @p capacity. */
size_t igtl_write_string(uint8_t *out, size_t capacity, const char *device, double time_s, const char *text);
/** A point of 3D Slicer: name, sRGB, RAS mm. */
struct igtl_point {
    char name[64];
    uint8_t rgb[3];
    double position[3];
};
size_t igtl_write_points(uint8_t *out, size_t capacity, const char *device, double time_s,
                         const struct igtl_point *points, size_t count);
size_t igtl_write_transform(uint8_t *out, size_t capacity, const char *device, double time_s, const double matrix[16]);
/** Asks a server for tracking data every @p milliseconds. */
size_t igtl_write_start(uint8_t *out, size_t capacity, const char *type, uint32_t milliseconds);

uint64_t igtl_crc(const uint8_t *bytes, size_t size);

/* A connection to a tracking station or to 3D Slicer by OpenIGTLink, on a thread of its own: the newest pose of each
 * tool is there to be asked for, whatever arrives and however fast, and what was selected goes back. */

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

/* Sends a selection to the programs that are connected: 3D Slicer shows it. */

/** Sends @p selection of @p selector: the rows of its report as NDJSON, and the contacts of its best results. */
void station_send_selection(struct station *station, const conus_selector *selector, const conus_atlas *atlas,
                            const conus_selection *selection);

#endif
