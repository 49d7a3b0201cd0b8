/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a session says of the lists of hits: columns, order, format of exported files. */
#ifndef CONUS_VIEWER_SESSION_SESSION_LIST_H
#define CONUS_VIEWER_SESSION_SESSION_LIST_H

#include "viewer/session/session.h"

#include <jansson.h>

/** Columns by name, in their order, null where none were chosen; "order" a name, and "reversed". */
json_t *session_list(const struct result_list *list);
/** Reads that; what @p root does not say is as it is in @p out. False: @p why says why not, and @p out is as before. */
bool session_list_read(struct result_list *out, const json_t *root, char why[SESSION_REASON]);

#endif
