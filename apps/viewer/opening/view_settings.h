/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the options of conus-view say. */
#ifndef CONUS_VIEWER_VIEW_SETTINGS_H
#define CONUS_VIEWER_VIEW_SETTINGS_H

#include "settings/settings.h"
#include "settings/station_settings.h"

struct view_settings {
    struct atlas_settings atlas;
    struct common_settings common;
    struct space_settings space;
    struct station_settings station;
    const char *poses;
    struct context_choice context;
    const char *transfer, *script, *session;
    uint32_t size[2];
    double scale;
    bool hidden, safe_colours, full_screen;
    const struct arguments *arguments; /* no option: that these came from; NULL = from none */
};

#endif
