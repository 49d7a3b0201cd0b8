/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The second tool in a session, an object `second`, and `device_speed`. */
#ifndef CONUS_VIEWER_SESSION_SESSION_SECOND_H
#define CONUS_VIEWER_SESSION_SESSION_SECOND_H

#include "viewer/session/session.h"

#include <jansson.h>

/** What a session keeps of tools and devices. */
struct session_tools {
    struct second second; /**< Without answers. */
    double speed;         /**< Of devices.h. */
};

/** Adds the second tool, and the speed of devices, as they are to @p root. */
void session_second_add(json_t *root, const struct window *window);
/** Reads what a session says of them: what it does not say is as the window has it. False: @p why says why not, in one
 * line. */
bool session_second_read(struct session_tools *out, const struct window *window, const json_t *root,
                         char why[SESSION_REASON]);
/** Takes over what was read. */
void session_second_put(struct window *window, const struct session_tools *tools);

#endif
