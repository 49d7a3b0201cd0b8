/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the device of each tool, and lets it move the tool. */
#include "viewer/window/hands.h"

#include "link/clock.h"
#include "viewer/tools/point.h"

#include <math.h>

const char *const hands_pointers[POINTER_COUNT] = {"mouse", "wand", "replay", "tracker", "spacemouse", "gamepad"};

struct tool hands_tool(struct window *window, enum hand hand)
{
    return (struct tool){.viewer = window->viewer, .second = hand == SECOND_HAND ? &window->second : NULL};
}

/* One device moves one tool; only a tracker knows two. */
static bool is_taken(const struct window *window)
{
    enum pointer first = window->viewer->cone.pointer;
    return first == window->second.pointer && first != POINT_BY_TRACKER;
}

static bool second_moves(const struct window *window)
{
    return window->second.on && !is_taken(window);
}

struct tool hands_moved_by(struct window *window, enum pointer pointer)
{
    if (window->viewer->cone.pointer == pointer) {
        return hands_tool(window, FIRST_HAND);
    }
    bool is_second = second_moves(window) && window->second.pointer == pointer;
    return is_second ? hands_tool(window, SECOND_HAND) : (struct tool){0};
}

void hands_choose(struct window *window, enum hand hand, enum pointer pointer)
{
    struct cone_state *cone = &window->viewer->cone;
    struct second *second = &window->second;
    bool *held = hand == SECOND_HAND ? &second->held : &cone->frozen;
    enum pointer *now = hand == SECOND_HAND ? &second->pointer : &cone->pointer;
    *held = *held && *now == pointer;
    *now = pointer;
    window->viewer->version++;
}

void hands_choose_next(struct window *window, enum hand hand)
{
    struct tool tool = hands_tool(window, hand);
    int next = ((int)tool_pointer(&tool) + 1) % POINTER_COUNT;
    next += hand == SECOND_HAND && next == POINT_BY_REPLAY;
    hands_choose(window, hand, (enum pointer)next);
    viewer_say(window->viewer, "%s tool: moved by the %s", hand == SECOND_HAND ? "second" : "first",
               hands_pointers[next]);
}

static void hear_trackers(struct window *window)
{
    struct devices *devices = &window->inputs.devices;
    const struct station_news *news = &window->inputs.news;
    const struct station_tool first = {.state = news->state, .pose = news->pose, .number = news->number};
    tracker_hear(&devices->trackers[0], window->inputs.station ? &first : NULL);
    if (window->inputs.second_station) {
        struct station_news other;
        station_ask(window->inputs.second_station, &other);
        const struct station_tool second = {.state = other.state, .pose = other.pose, .number = other.number};
        tracker_hear(&devices->trackers[1], &second);
    } else {
        tracker_hear(&devices->trackers[1],
                     window->inputs.station && window->inputs.has_second_tool ? &news->second : NULL);
    }
}

/* NULL where it is moved by hand, or not at all. */
static struct source *source_of(struct window *window, enum hand hand)
{
    struct tool tool = hands_tool(window, hand);
    struct devices *devices = &window->inputs.devices;
    if (hand == SECOND_HAND && !second_moves(window)) {
        return NULL;
    }
    switch (tool_pointer(&tool)) {
    case POINT_BY_TRACKER:
        return &devices->trackers[hand].source;
    case POINT_BY_MOUSE:
        return &devices->mouse.source;
    case POINT_BY_SPACEMOUSE:
        return &devices->spacemouse.source;
    case POINT_BY_GAMEPAD:
        return &devices->gamepad.source;
    default:
        return NULL;
    }
}

/* Returns whether it got a pose, or a move. */
static bool serve(struct window *window, enum hand hand, double now_s)
{
    struct tool tool = hands_tool(window, hand);
    struct source_news *heard = &window->inputs.devices.heard[hand];
    enum source_state was = heard->state;
    source_ask(source_of(window, hand), now_s, heard);
    window->viewer->version += heard->state != was; /* what is said of the tool is another now */
    return tool_take(&tool, heard);
}

bool hands_step(struct window *window, double now_s)
{
    hear_trackers(window);
    bool moved = serve(window, FIRST_HAND, now_s);
    serve(window, SECOND_HAND, now_s);
    second_update(&window->second, window->viewer);
    return moved;
}

double hands_rest(const struct window *window)
{
    static const double watch_s = 0.2; /* how often a tracker that says nothing is looked at */
    static const double look_s = 0.02; /* and what moves by hand; or */
    static const double seek_s = 0.5;  /* what may be plugged in */
    double seconds = window->inputs.second_station ? watch_s : INFINITY;
    for (int hand = FIRST_HAND; hand <= SECOND_HAND; hand++) {
        enum pointer pointer = hand == SECOND_HAND ? window->second.pointer : window->viewer->cone.pointer;
        bool is_asked = pointer >= POINT_BY_SPACEMOUSE && (hand == FIRST_HAND || second_moves(window));
        bool is_there = window->inputs.devices.heard[hand].state > SOURCE_ABSENT;
        seconds = is_asked ? fmin(seconds, is_there ? look_s : seek_s) : seconds;
    }
    return seconds;
}

void hands_point(struct window *window, const double eye[3], const double direction[3])
{
    struct tool tool = hands_moved_by(window, POINT_BY_MOUSE);
    conus_pose pose;
    if (tool.viewer && !tool_is_held(&tool) && point_find(&pose, tool.viewer, eye, direction)) {
        pushed_put(&window->inputs.devices.mouse, &pose);
        serve(window, tool.second ? SECOND_HAND : FIRST_HAND, 1e-3 * clock_ms());
        second_update(&window->second, window->viewer);
    }
}

static void find_second(struct notice *out, const struct window *window)
{
    const struct second *second = &window->second;
    const struct devices *devices = &window->inputs.devices;
    *out = (struct notice){0};
    if (is_taken(window)) {
        *out = (struct notice){.text = "the first tool has this device", .is_trouble = true};
    } else if (second->pointer == POINT_BY_TRACKER) {
        const struct tracker *tracker = &devices->trackers[SECOND_HAND];
        notice_of_tracker(out, second->has_pose, tracker->is_there, tracker->tool.state);
    } else if (second->pointer == POINT_BY_REPLAY) {
        *out = (struct notice){.text = "a replay moves the first tool only", .is_trouble = true};
    } else if (!second->has_pose && second->pointer < POINT_BY_SPACEMOUSE) {
        out->text = second->pointer == POINT_BY_MOUSE ? "move the mouse over the brain" : "press W to put it there";
    }
}

/* What is wrong with a device, or what is to be done with it. */
static void find_trouble(struct notice *out, const struct source_news *heard, bool has_pose, bool is_steered)
{
    if (heard->state == SOURCE_FROZEN) {
        *out = (struct notice){.text = "the same for 5 s: is it frozen?", .is_trouble = true};
    } else if (heard->state == SOURCE_BROKEN) {
        *out =
            (struct notice){.text = is_steered ? "its values are no numbers" : "OLD ANSWER: the values are no numbers",
                            .is_trouble = true,
                            .is_old = !is_steered};
    } else if (heard->text) {
        *out = (struct notice){.text = heard->text, .is_trouble = heard->state <= SOURCE_ABSENT};
    } else if (is_steered && !has_pose) {
        out->text = "move it to put the tool there";
    }
}

void hands_notice(struct notice *out, const struct window *window, enum hand hand)
{
    const struct viewer *viewer = window->viewer;
    bool is_held = hand == SECOND_HAND ? window->second.held : viewer->cone.frozen;
    enum pointer pointer = hand == SECOND_HAND ? window->second.pointer : viewer->cone.pointer;
    if (hand == SECOND_HAND) {
        find_second(out, window);
    } else {
        notice_find(out, viewer, window->inputs.station, &window->inputs.news, window->inputs.replay.poses);
    }
    bool has_pose = hand == SECOND_HAND ? window->second.has_pose : viewer->cone.has_pose;
    if (!out->is_trouble) {
        find_trouble(out, &window->inputs.devices.heard[hand], has_pose, pointer >= POINT_BY_SPACEMOUSE);
    }
    if (!out->text && is_held && (hand == SECOND_HAND || pointer >= POINT_BY_TRACKER)) {
        out->text = hand == SECOND_HAND ? "held: B lets it move again" : "held: Space lets it move again";
    }
}
