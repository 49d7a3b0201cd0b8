/* SPDX-License-Identifier: BSD-3-Clause */
/* All devices, and the sources that need no driver: a tracker's tool and the mouse. */
#include "viewer/devices/devices.h"

#include <string.h>

/* Gives the newest pose that was put there, once. */
static bool pushed_ask(struct source *source, double now_s, struct source_update *out, double said[SOURCE_VALUES])
{
    struct pushed *pushed = (struct pushed *)source;
    (void)now_s;
    (void)said; /* a mouse may rest for ever */
    out->state = SOURCE_WELL;
    out->has_pose = pushed->is_new;
    out->pose = pushed->pose;
    pushed->is_new = false;
    return false;
}

/* Gives each pose of a station's tool once. */
static bool tracker_ask(struct source *source, double now_s, struct source_update *out, double said[SOURCE_VALUES])
{
    static const enum source_state states[] = {SOURCE_ABSENT, SOURCE_SILENT, SOURCE_LOST, SOURCE_STALE, SOURCE_WELL};
    struct tracker *tracker = (struct tracker *)source;
    const struct station_tool *tool = &tracker->tool;
    bool is_seen = tracker->is_there && tool->state == STATION_SEEN;
    (void)now_s;
    out->state = tracker->is_there ? states[tool->state] : SOURCE_NONE;
    if (is_seen) {
        memcpy(said, tool->pose.world_from_device, sizeof tool->pose.world_from_device);
        out->pose = tool->pose;
        out->has_pose = tool->number != tracker->taken;
        tracker->taken = tool->number;
    }
    return is_seen;
}

void tracker_hear(struct tracker *tracker, const struct station_tool *tool)
{
    tracker->is_there = tool;
    tracker->tool = tool ? *tool : (struct station_tool){0};
    tracker->taken = tool ? tracker->taken : 0; /* another station counts anew */
}

void devices_init(struct devices *out)
{
    *out = (struct devices){.trackers = {{.source.ask = tracker_ask}, {.source.ask = tracker_ask}},
                            .mouse.source.ask = pushed_ask};
    spacemouse_init(&out->spacemouse);
    gamepad_init(&out->gamepad, gamepad_read);
}
