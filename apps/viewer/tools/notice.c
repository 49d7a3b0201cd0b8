/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds what is to be said of the cone. */
#include "viewer/tools/notice.h"

static void find_of_mouse(struct notice *out, const struct cone_state *cone)
{
    if (!cone->has_pose) {
        out->text = "move the mouse over the brain";
    } else if (cone->frozen) {
        out->text = "held: click again to follow";
    }
}

void notice_of_tracker(struct notice *out, bool has_pose, bool has_station, enum station_state state)
{
    static const char *const none[] = {"no tracker is connected yet", "no pose of the tool yet",
                                       "the tracker does not see the tool", "no pose of the tool for half a second",
                                       "tracking"};
    static const char *const old[] = {"OLD ANSWER: the tracker is gone", "OLD ANSWER: no pose of the tool",
                                      "OLD ANSWER: the tool is lost", "OLD ANSWER: the tool is silent", NULL};
    if (!has_station) {
        out->text = has_pose ? "OLD ANSWER: there is no tracker" : "no tracker: see --listen, --connect";
        out->is_trouble = true;
        out->is_old = has_pose;
    } else if (state != STATION_SEEN || !has_pose) {
        out->text = (has_pose ? old : none)[state];
        out->is_trouble = state != STATION_SEEN;
        out->is_old = has_pose;
    }
}

void notice_find(struct notice *out, const struct viewer *viewer, bool has_station, const struct station_news *news,
                 bool has_poses)
{
    const struct cone_state *cone = &viewer->cone;
    *out = (struct notice){0};
    if (cone->pointer == POINT_BY_MOUSE) {
        find_of_mouse(out, cone);
    } else if (cone->pointer == POINT_BY_TRACKER) {
        notice_of_tracker(out, cone->has_pose, has_station, news->state);
    } else if (cone->pointer == POINT_BY_REPLAY && !has_poses) {
        out->text = "no poses: see --poses";
        out->is_trouble = true;
    } else if (!cone->has_pose && cone->pointer < POINT_BY_SPACEMOUSE) {
        out->text = cone->pointer == POINT_BY_WAND ? "press W to put the device there" : "choose a row to be shown";
    }
}
