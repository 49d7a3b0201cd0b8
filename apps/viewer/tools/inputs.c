/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the device of each tool, lets it move the tool, and finds what is to be said of it. */
#include "viewer/tools/tools.h"

#include "base/geometry/math3.h"
#include "conus/own.h"
#include "options/progress.h"
#include "settings/settings.h"
#include "viewer/model/viewer.h"

#include <math.h>
#include <string.h>

static const char not_confirmed[] = "nothing is kept: the answer is old, its tool is not seen";

static const double farthest_radii = 3; /* from the brain's middle: a tool cannot be steered farther away */

/* Makes the columns perpendicular unit vectors, right-handed; z, the axis, keeps its direction. */
static void straighten(double m[16])
{
    double *y = m + 4;
    double *z = m + 8;
    vec3_normalise(z, z);
    vec3_add_scaled(y, y, -vec3_dot(y, z), z);
    vec3_normalise(y, y);
    vec3_cross(m, y, z);
}

/* Moves a pose by `move`, mm along its axes (-z is where it points, +y up), then turns it by `turn`, radians, a
 * rotation vector in its frame. It stays a rotation however often it is turned. */
static void steer_pose(conus_pose *pose, const double move[3], const double turn[3])
{
    double *m = pose->world_from_device;
    double axis[3];
    mat4_direction(axis, m, move);
    vec3_add_scaled(m + 12, m + 12, 1, axis);
    mat4_direction(axis, m, turn);
    if (vec3_normalise(axis, axis)) {
        for (int column = 0; column < 3; column++) {
            vec3_turn(m + (ptrdiff_t)4 * column, m + (ptrdiff_t)4 * column, axis, vec3_length(turn));
        }
        straighten(m);
    }
}

void inputs_steer(struct viewer *viewer, enum tool_number number, const double move[3], const double turn[3])
{
    if (!viewer->tools[number].has_pose) {
        tool_place(viewer, number);
        return;
    }
    conus_pose pose = viewer->tools[number].pose;
    double *at = pose.world_from_device + 12;
    const double *centre = viewer->centre;
    double offset[3];
    vec3_sub(offset, at, centre);
    const double most = fmax(vec3_length(offset), farthest_radii * viewer->radius);
    steer_pose(&pose, move, turn);
    vec3_sub(offset, at, centre);
    const double far = vec3_length(offset);
    if (far > most) { /* back along the line to the centre */
        vec3_add_scaled(at, centre, most / far, offset);
    }
    tool_aim(viewer, number, &pose);
}

static bool any(const double v[3])
{
    return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

/* Whether the tool has this very pose, so that nothing has moved. */
static bool is_at(const struct tool *tool, const conus_pose *pose)
{
    static const conus_frame world = {.space = CONUS_SPACE_RAS};
    conus_pose turned = *pose;
    conus_frame_turn_pose(&turned, &world, true); /* as tool_aim() keeps it */
    return tool->has_pose && pose_is_same(&turned, &tool->pose);
}

/* Applies what a source says to its tool. Returns whether there was another pose, or a move. */
static bool take_update(struct viewer *viewer, enum tool_number number, const struct source_update *update)
{
    bool is_new = update->has_pose && !is_at(&viewer->tools[number], &update->pose);
    bool moves = !viewer->tools[number].held && (is_new || any(update->move) || any(update->turn));
    if (moves && is_new) {
        tool_aim(viewer, number, &update->pose);
    } else if (moves) {
        inputs_steer(viewer, number, update->move, update->turn);
    }
    if (update->widen > 0) {
        tool_widen(viewer, number, update->widen);
    }
    if (update->pressed & SOURCE_RESET) {
        tool_place(viewer, number);
    }
    if (update->pressed & SOURCE_HOLD) {
        tool_hold(viewer, number);
    }
    if (update->pressed & SOURCE_CONFIRM) {
        tool_confirm(viewer, number);
    }
    return moves;
}

/* Why poses are dropped that the tracker has sent since the tool's newest one; NULL = none are. */
static const char *find_refusal(const struct inputs *inputs)
{
    const struct igtl_counts *now = &inputs->update.counts;
    return now->mirrored > inputs->seen.mirrored ? "poses are dropped: they are mirrored"
           : now->refused > inputs->seen.refused ? "poses are dropped: scaled, or no numbers"
                                                 : NULL;
}

/* Asks the station what is new. The tracked head moves along. */
static void hear_station(struct inputs *inputs, struct viewer *viewer)
{
    struct station_update *update = &inputs->update;
    const char *trouble = update->trouble;
    const char *refusal = find_refusal(inputs);
    uint64_t number = update->number;
    station_ask(inputs->station, update);
    inputs->seen = update->number == number ? inputs->seen : update->counts;
    viewer->said += update->trouble != trouble; /* a frame that says so */
    viewer->version += find_refusal(inputs) != refusal;
    if (viewer->head.named) {
        head_set_state(&viewer->head, update->head.state);
        if (update->head.state == STATION_SEEN) {
            head_move(&viewer->head, update->head.eye, &update->head.screen);
        }
    }
}

static void hear_trackers(struct inputs *inputs)
{
    struct tracker *trackers = inputs->devices.trackers;
    const struct station_update *update = &inputs->update;
    const struct station_tool first = {.state = update->state, .pose = update->pose, .number = update->number};
    tracker_hear(&trackers[FIRST_TOOL], inputs->station ? &first : NULL);
    if (inputs->second_station) {
        struct station_update other;
        station_ask(inputs->second_station, &other);
        const struct station_tool second = {.state = other.state, .pose = other.pose, .number = other.number};
        tracker_hear(&trackers[SECOND_TOOL], &second);
    } else {
        tracker_hear(&trackers[SECOND_TOOL], inputs->station && inputs->has_second_tool ? &update->second : NULL);
    }
}

/* The source that moves a tool; NULL where keys, a replay or nothing does. */
static struct source *source_of(struct inputs *inputs, const struct viewer *viewer, enum tool_number number)
{
    struct devices *devices = &inputs->devices;
    if (!tool_is_moved(viewer, number)) {
        return NULL;
    }
    switch (viewer->tools[number].pointer) {
    case POINT_BY_TRACKER:
        return &devices->trackers[number].source;
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

/* Asks the source of a tool and applies what it says. Returns whether there was a pose, or a move. */
static bool move_by_source(struct inputs *inputs, struct viewer *viewer, enum tool_number number, double now_s)
{
    struct source_update *received = &inputs->devices.received[number];
    enum source_state was = received->state;
    source_ask(source_of(inputs, viewer, number), now_s, received);
    viewer->version += received->state != was; /* the notice about the tool changes */
    if (received->state == SOURCE_WELL && was != SOURCE_WELL && strcmp(viewer->message, not_confirmed) == 0) {
        viewer_say(viewer, "%s", ""); /* it would be now */
    }
    return take_update(viewer, number, received);
}

bool inputs_step(struct inputs *inputs, struct viewer *viewer, double now_s)
{
    if (inputs->station) {
        hear_station(inputs, viewer);
    }
    hear_trackers(inputs);
    bool moved = move_by_source(inputs, viewer, FIRST_TOOL, now_s);
    move_by_source(inputs, viewer, SECOND_TOOL, now_s);
    tool_update_second(viewer);
    return moved;
}

double inputs_idle_s(const struct inputs *inputs, const struct viewer *viewer)
{
    static const double watch_s = 0.2; /* how often a tracker that says nothing is looked at, */
    static const double look_s = 0.02; /* what moves by hand, */
    static const double seek_s = 0.5;  /* and what may be plugged in */
    double seconds = inputs->second_station ? watch_s : INFINITY;
    for (enum tool_number number = FIRST_TOOL; number < TOOL_COUNT; number++) {
        if (viewer->tools[number].pointer >= POINT_BY_SPACEMOUSE && tool_is_moved(viewer, number)) {
            bool is_there = inputs->devices.received[number].state > SOURCE_ABSENT;
            seconds = fmin(seconds, is_there ? look_s : seek_s);
        }
    }
    return seconds;
}

void inputs_point(struct inputs *inputs, struct viewer *viewer, const double eye[3], const double direction[3])
{
    enum tool_number number = tool_moved_by(viewer, POINT_BY_MOUSE);
    conus_pose pose;
    if (number < TOOL_COUNT && !viewer->tools[number].held && point_find(&pose, viewer, eye, direction)) {
        inputs->devices.mouse.pose = pose;
        inputs->devices.mouse.is_new = true;
        move_by_source(inputs, viewer, number, 1e-3 * clock_ms());
        tool_update_second(viewer);
    }
}

bool inputs_connect(struct inputs *inputs, void (*wake)(void))
{
    static const struct station_settings none = {.listen = NULL};
    bool fine = !station_settings_connect(&inputs->station, inputs->asked ? inputs->asked : &none, inputs->address);
    if (fine) {
        station_on_pose(inputs->station, wake);
    }
    return fine;
}

void inputs_disconnect(struct inputs *inputs, struct viewer *viewer)
{
    station_stop(inputs->station);
    inputs->station = NULL;
    inputs->update = (struct station_update){0};
    inputs->seen = (struct igtl_counts){0};
    if (viewer->head.named) {
        head_set_state(&viewer->head, STATION_WAITING);
    }
    viewer->version++;
}

/* @p refusal is why its poses are dropped, or NULL. */
static struct notice notice_of_tracker(bool has_pose, bool has_station, enum station_state state, const char *refusal)
{
    static const char *const none[] = {"no tracker is connected yet", "no pose of the tool yet",
                                       "the tracker does not see the tool", "no pose of the tool for half a second",
                                       "tracking"};
    static const char *const old[] = {"no tracker is connected", "no pose of the tool", "the tool is lost",
                                      "the tool is silent", NULL};
    if (!has_station) {
        return (struct notice){has_pose ? "there is no tracker" : "no tracker: connect one below Point with", true,
                               has_pose};
    }
    if (state == STATION_SEEN && has_pose) {
        return (struct notice){0};
    }
    return (struct notice){refusal ? refusal : (has_pose ? old : none)[state], state != STATION_SEEN, has_pose};
}

static struct notice notice_of_first(const struct inputs *inputs, const struct viewer *viewer)
{
    const struct tool *tool = &viewer->tools[FIRST_TOOL];
    struct notice notice = {0};
    if (tool->pointer == POINT_BY_TRACKER) {
        notice = notice_of_tracker(tool->has_pose, inputs->station, inputs->update.state, find_refusal(inputs));
    } else if (tool->pointer == POINT_BY_REPLAY && !inputs->replay.poses && !viewer->points.count) {
        notice = (struct notice){"no list: open one, or see --poses", true, false};
    } else if (tool->pointer == POINT_BY_MOUSE) {
        notice.text = !tool->has_pose ? "move the mouse over the brain"
                      : tool->held    ? "held: click again to follow"
                                      : NULL;
    } else if (!tool->has_pose && tool->pointer < POINT_BY_SPACEMOUSE) {
        notice.text = tool->pointer == POINT_BY_WAND ? "press W to place the device" : "choose a row to be shown";
    }
    return notice;
}

static struct notice notice_of_second(const struct inputs *inputs, const struct viewer *viewer)
{
    const struct tool *tool = &viewer->tools[SECOND_TOOL];
    const struct tracker *tracker = &inputs->devices.trackers[SECOND_TOOL];
    struct notice notice = {0};
    if (tool_second_is_taken(viewer)) {
        notice = (struct notice){"the first tool has this device", true, false};
    } else if (tool->pointer == POINT_BY_TRACKER) {
        notice = notice_of_tracker(tool->has_pose, tracker->is_there, tracker->tool.state,
                                   inputs->second_station ? NULL : find_refusal(inputs));
    } else if (tool->pointer == POINT_BY_REPLAY) {
        notice = (struct notice){"a replay moves the first tool only", true, false};
    } else if (!tool->has_pose && tool->pointer < POINT_BY_SPACEMOUSE) {
        notice.text = tool->pointer == POINT_BY_MOUSE ? "move the mouse over the brain" : "press W to place it";
    }
    return notice;
}

/* Says what is wrong with a device, or how to use it. */
static void find_trouble(struct notice *out, const struct source_update *received, const struct tool *tool,
                         enum tool_number number)
{
    static const char *const held_frozen[TOOL_COUNT] = {
        "held: Space lets it move again; the same for 5 s: is it frozen?",
        "held: 4 lets it move again; the same for 5 s: is it frozen?"};
    bool is_steered = tool->pointer >= POINT_BY_SPACEMOUSE;
    if (received->state == SOURCE_FROZEN) {
        *out = (struct notice){tool->held ? held_frozen[number] : "the same for 5 s: is it frozen?", true, false};
    } else if (received->state == SOURCE_BROKEN) {
        *out =
            (struct notice){is_steered ? "its values are no numbers" : "the values are no numbers", true, !is_steered};
    } else if (received->text) {
        *out = (struct notice){received->text, received->state <= SOURCE_ABSENT, false};
    } else if (is_steered && !tool->has_pose) {
        out->text = "move it to put the tool there";
    }
}

void inputs_notice(struct notice *out, const struct inputs *inputs, const struct viewer *viewer,
                   enum tool_number number)
{
    static const char *const held[TOOL_COUNT] = {"held: Space lets it move again", "held: 4 lets it move again"};
    const struct tool *tool = &viewer->tools[number];
    *out = number == SECOND_TOOL ? notice_of_second(inputs, viewer) : notice_of_first(inputs, viewer);
    if (!out->is_trouble) {
        find_trouble(out, &inputs->devices.received[number], tool, number);
    }
    if (!out->text && tool->held && (number == SECOND_TOOL || tool->pointer >= POINT_BY_TRACKER)) {
        out->text = held[number];
    }
}

bool inputs_is_old(const struct inputs *inputs, const struct viewer *viewer, enum tool_number number)
{
    struct notice notice;
    inputs_notice(&notice, inputs, viewer, number);
    return notice.is_old;
}

void inputs_confirm(const struct inputs *inputs, struct viewer *viewer, enum tool_number number)
{
    if (inputs_is_old(inputs, viewer, number)) {
        viewer_say(viewer, "%s", not_confirmed);
        return;
    }
    if (number == FIRST_TOOL && plans_has_needle(viewer)) { /* what the answer is about */
        plans_keep(viewer);
    } else {
        tool_confirm(viewer, number);
    }
}

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
    if (row->error) {
        viewer_say(viewer, "line %zu: %s", row->line, row->error);
        return;
    }
    points_aim(viewer, row);
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

double replay_idle_s(const struct replay *replay, const struct viewer *viewer, double clock)
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
