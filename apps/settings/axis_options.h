/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options about what an axis passes: --segments, --order, --contacts. */
#ifndef CONUS_SETTINGS_AXIS_OPTIONS_H
#define CONUS_SETTINGS_AXIS_OPTIONS_H

#include "settings/settings.h"

struct axis_settings {
    const char *segments;
    size_t order; /* conus_order */
    const char *contacts;
};

extern const struct option axis_options[]; /**< axis_settings */

/** Message for a pose that is only a point where an axis is wanted. */
#define POINT_HAS_NO_AXIS "a point, without the direction that an axis needs"

/** What --contacts says; of none, a count of 0. Returns the exit code and prints an error unless it is 0. */
int settings_contacts(conus_contacts *out, const struct axis_settings *settings);

#endif
