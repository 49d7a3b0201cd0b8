/* SPDX-License-Identifier: BSD-3-Clause */
/* The first tool is the viewer's cone, the second one is beside it. */
#include "viewer/tools/tool.h"

#include "viewer/devices/steer.h"
#include "viewer/tools/point.h"

#include <math.h>

static const double beside = 1.6; /* radii from the brain's middle, where the second tool starts */
static const double farthest = 3; /* radii: it cannot be steered farther away */
static const double least_angle = 0.1, most_angle = 179;

enum pointer tool_pointer(const struct tool *tool)
{
    return tool->second ? tool->second->pointer : tool->viewer->cone.pointer;
}

bool tool_is_held(const struct tool *tool)
{
    return tool->second ? tool->second->held : tool->viewer->cone.frozen;
}

const conus_pose *tool_pose(const struct tool *tool)
{
    bool has_pose = tool->second ? tool->second->has_pose : tool->viewer->cone.has_pose;
    const conus_pose *pose = tool->second ? &tool->second->pose : &tool->viewer->cone.pose;
    return has_pose ? pose : NULL;
}

void tool_aim(const struct tool *tool, const conus_pose *pose)
{
    if (tool->second) {
        second_aim(tool->second, pose);
    } else {
        viewer_aim(tool->viewer, pose);
    }
}

void tool_hold(const struct tool *tool)
{
    struct second *second = tool->second;
    if (!second) {
        point_hold(tool->viewer);
        return;
    }
    second->held = !second->held && second->has_pose;
    tool->viewer->version++;
    viewer_say(tool->viewer, second->held       ? "the second tool stays where it is"
                             : second->has_pose ? "the second tool moves again"
                                                : "the second tool has no pose to hold");
}

void tool_widen(const struct tool *tool, double factor)
{
    double now = tool->second ? second_angle(tool->second) : tool->viewer->cone.angle;
    *(tool->second ? &tool->second->angle : &tool->viewer->cone.angle) =
        fmin(fmax(now * factor, least_angle), most_angle);
    if (tool->second) {
        second_touch(tool->second);
    } else {
        viewer_reselect(tool->viewer);
    }
}

void tool_place(const struct tool *tool)
{
    struct viewer *viewer = tool->viewer;
    const double *c = viewer->centre;
    conus_pose pose;
    if (!tool->second) {
        viewer->cone.has_pose = false;
        viewer_place(viewer);
    } else if (!conus_pose_along(&pose, (const double[]){c[0] + beside * viewer->radius, c[1], c[2]},
                                 (const double[]){-1, 0, 0}, NULL)) {
        tool_aim(tool, &pose);
    }
}

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

void tool_steer(const struct tool *tool, const double move[3], const double turn[3])
{
    if (!tool_pose(tool)) {
        tool_place(tool);
    } else {
        const struct viewer *viewer = tool->viewer;
        conus_pose pose = *tool_pose(tool);
        double before = distance(pose.world_from_device + 12, viewer->centre);
        steer_pose(&pose, move, turn);
        steer_within(&pose, viewer->centre, fmax(before, farthest * viewer->radius));
        tool_aim(tool, &pose);
    }
}

void tool_confirm(const struct tool *tool)
{
    struct viewer *viewer = tool->viewer;
    if (!tool->second) {
        viewer_confirm(viewer);
        return;
    }
    size_t drawn = (size_t)(viewer->drawn - viewer->atlases);
    second_update(tool->second, viewer);
    const conus_result *best = conus_selection_result(second_selection(tool->second, drawn), 0);
    if (!best || !best->object) {
        viewer_say(viewer, "nothing in the second tool's cone to confirm");
        return;
    }
    viewer_pin(viewer, drawn, best->object, NULL, best->share, best->distance, best->contact);
    viewer->version++;
    char title[VIEW_ATLAS_TITLE];
    viewer_say(viewer, "confirmed by the second tool: %s",
               viewer_pin_title(title, viewer, &viewer->pins[viewer->pin_count - 1]));
}

static bool any(const double v[3])
{
    return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

static void press(const struct tool *tool, unsigned pressed)
{
    if (pressed & SOURCE_RESET) {
        tool_place(tool);
    }
    if (pressed & SOURCE_HOLD) {
        tool_hold(tool);
    }
    if (pressed & SOURCE_CONFIRM) {
        tool_confirm(tool);
    }
}

bool tool_take(const struct tool *tool, const struct source_news *news)
{
    bool moves = !tool_is_held(tool) && (news->has_pose || any(news->move) || any(news->turn));
    if (moves && news->has_pose) {
        tool_aim(tool, &news->pose);
    } else if (moves) {
        tool_steer(tool, news->move, news->turn);
    }
    if (news->widen > 0) {
        tool_widen(tool, news->widen);
    }
    press(tool, news->pressed);
    return moves;
}
