/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the options of conus-view say. */
#ifndef CONUS_VIEWER_VIEW_SETTINGS_H
#define CONUS_VIEWER_VIEW_SETTINGS_H

#include "settings/settings.h"
#include "settings/station_settings.h"

/* How an atlas that is open is opened again. */
struct again {
    bool trusts;    /* bundles may lie where the areas are not: that was said */
    bool doubts;    /* they do, and so it is not opened */
    char note[256]; /* the first that the atlas did not have before; "" = there is none */
};

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
    struct again *again;               /* likewise: the atlas is open, and is opened with these; NULL = it is another */
};

#endif
