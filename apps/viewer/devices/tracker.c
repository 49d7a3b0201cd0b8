/* SPDX-License-Identifier: BSD-3-Clause */
/* Each pose of a station's tool, once. */
#include "viewer/devices/tracker.h"

#include <string.h>

static bool ask(struct source *source, double now_s, struct source_news *out, double said[SOURCE_VALUES])
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

void tracker_init(struct tracker *out)
{
    *out = (struct tracker){.source.ask = ask};
}

void tracker_hear(struct tracker *tracker, const struct station_tool *tool)
{
    tracker->is_there = tool;
    tracker->tool = tool ? *tool : (struct station_tool){0};
}
