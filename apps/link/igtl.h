/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * OpenIGTLink, the protocol of trackers and of 3D Slicer: poses of tools in, texts and points out. Header versions 1
 * and 2. Strict, as what comes over a network must be: sizes are checked before they are believed, and nothing but
 * poses is kept.
 *
 * Header, 58 bytes, big-endian: version u16, type char[12], device char[20], time u32.u32, body size u64, CRC64 of the
 * body u64 (ECMA-182). Version 2 bodies begin with an extended header of 12 bytes or more and end with metadata. */
#ifndef CONUS_LINK_IGTL_H
#define CONUS_LINK_IGTL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/** Hears of each message with poses. */
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

#endif
