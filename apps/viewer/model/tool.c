/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves tools and asks the atlases what their cones hit. */
#include "viewer/model/viewer.h"

#include "base/geometry/math3.h"
#include "conus/own.h"
#include "options/progress.h"

#include <math.h>

static const double start_radii = 1.6; /* from the brain's middle, where a tool starts */
static const double least_angle = 0.1, most_angle = 179;

static const char *const ordinals[TOOL_COUNT] = {"first", "second"};

const char *const pointer_names[POINTER_COUNT] = {"mouse", "wand", "replay", "tracker", "spacemouse", "gamepad"};

/* Asks all atlases. One that cannot answer loses its answer. */
static void ask_atlases(struct viewer *viewer, enum tool_number number)
{
    struct tool *tool = &viewer->tools[number];
    double begun = clock_ms();
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        struct view_atlas *view = &viewer->atlases[i];
        conus_selector_options options;
        double angle = viewer_query(&options, viewer, number, i);
        conus_status status = view_atlas_select(view, number, &options, &tool->pose, tool->is_point ? NAN : angle);
        if (status) {
            const char *whose = number == SECOND_TOOL ? "second tool" : view->name;
            viewer_say(viewer, "%s%s%s", whose, whose[0] ? ": " : "",
                       status == CONUS_ERROR_MEMORY ? "not enough memory" : conus_message());
        }
    }
    tool->select_ms = clock_ms() - begun;
    tool->answer_number++;
}

static void forget(struct viewer *viewer, enum tool_number number)
{
    for (size_t i = 0; i < viewer->atlas_count; i++) {
        view_atlas_forget(&viewer->atlases[i], number);
    }
    viewer->tools[number].answer_number++;
}

void tool_reselect(struct viewer *viewer)
{
    viewer->version++;
    if (!viewer->tools[FIRST_TOOL].has_pose) {
        forget(viewer, FIRST_TOOL);
        return;
    }
    ask_atlases(viewer, FIRST_TOOL);
    const conus_result *best = conus_selection_result(viewer_selection(viewer), 0);
    if (viewer->cone.follow == FOLLOW_TIP) {
        viewer_cross(viewer, viewer->tools[FIRST_TOOL].pose.world_from_device + 12);
    } else if (viewer->cone.follow == FOLLOW_CONTACT && best && best->object && best->pixels) { /* there is a contact */
        viewer_cross(viewer, best->contact);
    }
}

void tool_clear(struct viewer *viewer)
{
    viewer->tools[FIRST_TOOL].has_pose = viewer->tools[FIRST_TOOL].held = false;
    viewer->chosen_point = 0;
    tool_reselect(viewer);
}

void tool_changed(struct viewer *viewer, enum tool_number number)
{
    if (number == FIRST_TOOL) {
        tool_reselect(viewer);
    } else {
        viewer->tools[number].is_asked = false;
        viewer->tools[number].version++;
    }
}

uint64_t tool_answer_sum(const struct viewer *viewer)
{
    const conus_selection *selection = viewer_selection(viewer);
    uint64_t sum = 0xCBF29CE484222325; /* FNV-1a */
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        unsigned how = result->pixels ? 2 : result->pierced ? 1 : 0;
        unsigned weight = (unsigned)(1000 * conus_selection_weight(selection, result->object));
        sum = (sum ^ ((uint64_t)result->object << 12 | weight << 2 | how)) * 0x100000001B3;
    }
    return selection ? sum : 0;
}

static void aim(struct viewer *viewer, enum tool_number number, const conus_pose *pose, bool is_point)
{
    static const conus_frame world = {.space = CONUS_SPACE_RAS};
    const unsigned version = viewer->version;
    const uint64_t sum = number == FIRST_TOOL ? tool_answer_sum(viewer) : 0;
    viewer->tools[number].pose = *pose;
    conus_frame_turn_pose(&viewer->tools[number].pose, &world, true); /* as the mouse turns it, and pictures show it */
    viewer->tools[number].has_pose = true;
    viewer->tools[number].is_point = is_point;
    tool_changed(viewer, number);
    if (number == FIRST_TOOL && tool_answer_sum(viewer) == sum) {
        viewer->moves += viewer->version - version;
    }
}

void tool_aim(struct viewer *viewer, enum tool_number number, const conus_pose *pose)
{
    aim(viewer, number, pose, false);
}

void tool_aim_point(struct viewer *viewer, enum tool_number number, const conus_pose *pose)
{
    aim(viewer, number, pose, true);
}

bool tool_has_cone(const struct viewer *viewer, enum tool_number number)
{
    const struct tool *tool = &viewer->tools[number];
    return tool->has_pose && !tool->is_point && (number == FIRST_TOOL || tool->on);
}

void tool_aim_along(struct viewer *viewer, enum tool_number number, const double origin[3], const double direction[3])
{
    conus_pose pose;
    if (conus_pose_along(&pose, origin, direction, NULL)) {
        viewer_say(viewer, "%s", conus_message());
    } else {
        conus_frame_turn_pose(&pose, &viewer->frame, false);
        tool_aim(viewer, number, &pose);
    }
}

void tool_place(struct viewer *viewer, enum tool_number number)
{
    static const double directions[TOOL_COUNT][3] = {{0, -1, 0}, {-1, 0, 0}};
    double origin[3];
    vec3_add_scaled(origin, viewer->centre, -start_radii * viewer->radius, directions[number]);
    tool_aim_along(viewer, number, origin, directions[number]);
}

void tool_hold(struct viewer *viewer, enum tool_number number)
{
    static const struct {
        const char *held, *none, *follows, *moves;
    } says[TOOL_COUNT] = {{"the cone stays where it is", "there is no cone to hold", "the cone follows the mouse",
                           "the cone moves again"},
                          {"the second tool stays where it is", "the second tool has no pose to hold",
                           "the second tool moves again", "the second tool moves again"}};
    struct tool *tool = &viewer->tools[number];
    tool->held = !tool->held && tool->has_pose;
    viewer->version++;
    viewer_say(viewer, "%s",
               tool->held                        ? says[number].held
               : !tool->has_pose                 ? says[number].none
               : tool->pointer == POINT_BY_MOUSE ? says[number].follows
                                                 : says[number].moves);
}

void tool_widen(struct viewer *viewer, enum tool_number number, double factor)
{
    double *angle = &viewer->tools[number].angle;
    *angle = fmin(fmax(*angle * factor, least_angle), most_angle);
    tool_changed(viewer, number);
}

void tool_confirm(struct viewer *viewer, enum tool_number number)
{
    static const char *const whose[TOOL_COUNT] = {"", "second tool's "};
    char title[VIEW_ATLAS_TITLE];
    if (number == SECOND_TOOL) {
        tool_update_second(viewer);
    }
    const conus_result *best = conus_selection_result(view_atlas_selection(viewer->drawn, number), 0);
    if (!best || !best->object) {
        viewer_say(viewer, "nothing in the %scone to keep", whose[number]);
        return;
    }
    viewer_pin(viewer, (struct pin){.atlas = (size_t)(viewer->drawn - viewer->atlases),
                                    .object = best->object,
                                    .share = best->share,
                                    .distance = best->distance,
                                    .contact = {best->contact[0], best->contact[1], best->contact[2]}});
    const char *name = viewer_pin_title(title, viewer, &viewer->pins[viewer->pin_count - 1]);
    if (number == SECOND_TOOL) {
        viewer->version++;
        viewer_say(viewer, "kept, of the second tool: %s", name);
    } else {
        viewer_say(viewer, "kept: %s, %.1f mm from the start", name, best->distance);
    }
}

void tool_choose(struct viewer *viewer, enum tool_number number, enum pointer pointer)
{
    struct tool *tool = &viewer->tools[number];
    tool->held = tool->held && tool->pointer == pointer;
    tool->pointer = pointer;
    viewer->chosen_point *= number != FIRST_TOOL || pointer == POINT_BY_REPLAY; /* of whose row it is not any more */
    viewer->version++;
}

void tool_choose_next(struct viewer *viewer, enum tool_number number)
{
    int next = ((int)viewer->tools[number].pointer + 1) % POINTER_COUNT;
    next += number == SECOND_TOOL && next == POINT_BY_REPLAY;
    tool_choose(viewer, number, (enum pointer)next);
    viewer_say(viewer, "%s tool: moved by the %s", ordinals[number], pointer_names[next]);
}

bool tool_second_is_taken(const struct viewer *viewer)
{
    enum pointer first = viewer->tools[FIRST_TOOL].pointer;
    return first == viewer->tools[SECOND_TOOL].pointer && first != POINT_BY_TRACKER; /* which knows two tools */
}

void tool_use_second(struct viewer *viewer, bool on)
{
    struct tool *second = &viewer->tools[SECOND_TOOL];
    second->on = on;
    if (!on) {
        forget(viewer, SECOND_TOOL);
    } else if (tool_second_is_taken(viewer)) {
        second->pointer = second->pointer == POINT_BY_WAND ? POINT_BY_MOUSE : POINT_BY_WAND;
    }
    tool_changed(viewer, SECOND_TOOL);
}

void tool_update_second(struct viewer *viewer)
{
    struct tool *second = &viewer->tools[SECOND_TOOL];
    unsigned now = viewer->tools[FIRST_TOOL].answer_number;
    bool is_asked = second->is_asked && second->asked_after == now;
    if (!second->on || is_asked) {
        return;
    }
    forget(viewer, SECOND_TOOL);
    if (second->has_pose) {
        ask_atlases(viewer, SECOND_TOOL);
    }
    second->is_asked = true;
    second->asked_after = now;
    second->version++;
}

bool tool_is_moved(const struct viewer *viewer, enum tool_number number)
{
    return number == FIRST_TOOL || (viewer->tools[number].on && !tool_second_is_taken(viewer));
}

enum tool_number tool_moved_by(const struct viewer *viewer, enum pointer pointer)
{
    enum tool_number number = FIRST_TOOL;
    while (number < TOOL_COUNT && !(viewer->tools[number].pointer == pointer && tool_is_moved(viewer, number))) {
        number++;
    }
    return number;
}
