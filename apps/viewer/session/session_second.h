/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The second tool in a session: an object `second`. */
#ifndef CONUS_VIEWER_SESSION_SESSION_SECOND_H
#define CONUS_VIEWER_SESSION_SESSION_SECOND_H

#include "viewer/session/session.h"

#include <jansson.h>

/** Of the tool as it is; NULL without memory. */
json_t *session_second(const struct second *second);
/** Reads what a session says of it into @p out, which has no answers: what it does not say is as in @p now. False: @p
 * why says why not, in one line. */
bool session_second_read(struct second *out, const struct second *now, const json_t *root, char why[SESSION_REASON]);
/** Takes over what was read. */
void session_second_put(struct window *window, const struct second *read);

#endif
