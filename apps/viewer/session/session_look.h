/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a session says of how each atlas looks, and of the background, the context's colours, the sheet of
 * figures, and how the window is divided. */
#ifndef CONUS_VIEWER_SESSION_SESSION_LOOK_H
#define CONUS_VIEWER_SESSION_SESSION_LOOK_H

#include "viewer/session/session.h"

#include <jansson.h>

/** Grey values of the cuts, opacities, pathways as haze; NULL without memory. */
json_t *session_look(const struct view_atlas *on);
/** Reads that into @p out, to be finished; false where it does not fit, and @p out is empty. */
bool session_look_read(struct look *out, const struct view_atlas *on, const json_t *entry, char why[SESSION_REASON]);

/** A name of one, NULL = @p backdrop stays as it is. */
bool session_backdrop_read(enum backdrop *backdrop, const json_t *name, char why[SESSION_REASON]);

/** The sheet of figures. */
json_t *session_sheet(const struct sheet *sheet);
/** NULL = it stays as it is. */
bool session_sheet_read(struct sheet *sheet, const json_t *entry, char why[SESSION_REASON]);

/** How the window is divided. */
json_t *session_layout(const struct layout *layout);
/** NULL = it stays as it is. */
bool session_layout_read(struct layout *layout, const json_t *entry, char why[SESSION_REASON]);

/** The name of a preset of transfer functions, for @p on; null and NULL = none. */
bool session_preset_read(const char **preset, const struct view_atlas *on, const json_t *name,
                         char why[SESSION_REASON]);

#endif
