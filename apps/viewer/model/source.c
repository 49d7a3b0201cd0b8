/* SPDX-License-Identifier: BSD-3-Clause */
/* Replays a file of poses, and follows a tracked head. */
#include "viewer/model/source.h"

#include <math.h>

static const double default_step_s = 0.1;

double replay_time(const struct replay *replay, size_t index)
{
    double first = conus_pose_list_row(replay->poses, 0)->time_s;
    double time = conus_pose_list_row(replay->poses, index)->time_s;
    return isfinite(time - first) ? time - first : default_step_s * (double)index;
}

void replay_show(struct replay *replay, struct viewer *viewer, size_t index)
{
    const conus_pose_row *row = conus_pose_list_row(replay->poses, index);
    replay->at = index;
    if (row->error || row->is_point) {
        viewer_say(viewer, "line %zu: %s", row->line, row->error ? row->error : "a point, which has no direction");
        return;
    }
    if (row->angle > 0 && viewer->cone.options.radius == 0) {
        viewer->tools[FIRST_TOOL].angle = row->angle * 180 / M_PI;
    }
    tool_aim(viewer, FIRST_TOOL, &row->pose);
    if (row->trigger) {
        tool_confirm(viewer, FIRST_TOOL);
    }
}

void replay_toggle(struct replay *replay, double clock)
{
    size_t count = conus_pose_list_count(replay->poses);
    replay->playing = !replay->playing && count > 0;
    replay->at = replay->at + 1 < count ? replay->at : 0;
    replay->from = replay->at;
    replay->started = clock;
}

double replay_rest(const struct replay *replay, const struct viewer *viewer, double clock)
{
    if (!replay->playing || viewer->tools[FIRST_TOOL].pointer != POINT_BY_REPLAY ||
        replay->at + 1 >= conus_pose_list_count(replay->poses)) {
        return INFINITY;
    }
    double next = replay_time(replay, replay->at + 1) - replay_time(replay, replay->from);
    return fmax(next - (clock - replay->started), 0.001);
}

bool replay_step(struct replay *replay, struct viewer *viewer, double clock)
{
    size_t count = conus_pose_list_count(replay->poses);
    size_t at = replay->at;
    if (!replay->playing || viewer->tools[FIRST_TOOL].pointer != POINT_BY_REPLAY) {
        return false;
    }
    double time = replay_time(replay, replay->from) + clock - replay->started;
    while (at + 1 < count && replay_time(replay, at + 1) <= time) {
        at++;
    }
    if (at != replay->at) {
        replay_show(replay, viewer, at);
    }
    replay->playing = at + 1 < count;
    return true;
}

static void show_head(struct head *head, const struct station_head *news)
{
    if (head->named) {
        head_set_state(head, news->state);
        if (news->state == STATION_SEEN) {
            head_move(head, news->eye, &news->screen);
        }
    }
}

void station_hear(struct station *station, struct viewer *viewer, struct station_news *news)
{
    station_ask(station, news);
    show_head(&viewer->head, &news->head);
}
