/* SPDX-License-Identifier: BSD-3-Clause */
/* What a tool is drawn with, and the ball by which the mouse turns its cone. */
#include "viewer/panes/panes.h"

#include "base/look.h"

#include <math.h>

static const ui_colour colours[TOOL_COUNT] = {{LOOK_RGB(LOOK_CONE), 255}, {LOOK_RGB(LOOK_SECOND), 255}};
static const ui_colour old_colour = {LOOK_RGB(LOOK_CONE_OLD), 255}; /* where the tool is not seen */

/* Pixels at scale 1. */
static const float width = 2;
static const float ball = 8, grip = 4; /* its radius, and how far beside it the mouse takes it */
static const float end_on = 20;        /* nearer to its entry it is not drawn: it would hide what the cone points at */

enum { HALVINGS = 6 };

bool pane_tool_shows(const struct window *window, enum tool_number number)
{
    return tool_has_cone(window->viewer, number);
}

struct pen pane_tool_pen(const struct window *window, enum tool_number number)
{
    ui_colour colour = inputs_is_old(&window->inputs, window->viewer, number) ? old_colour : colours[number];
    return (struct pen){colour, width, window->screen.scale};
}

void pane_ball_place(struct window *window, enum tool_number number)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    struct cone_sight *sight = &window->pictures.cones[number];
    const conus_pose *pose = &window->viewer->tools[number].pose;
    float margin = (ball + width) * window->screen.scale;
    double seen = 0;
    double step = sight->extent.reach;
    sight->turned = sight->extent;
    for (int i = 0; i < HALVINGS; i++) { /* the whole way at once, or by halves */
        float at[2];
        sight->turned.reach = seen + step;
        extent_ball(sight->ball, &sight->turned, pose);
        bool is_seen = window_point(at, window, sight->ball) && at[0] > box->x + margin &&
                       at[0] < box->x + box->width - margin && at[1] > box->y + margin &&
                       at[1] < box->y + box->height - margin;
        seen += is_seen ? step : 0;
        if (is_seen && i == 0) {
            return;
        }
        step /= 2;
    }
    sight->turned.reach = seen;
    extent_ball(sight->ball, &sight->turned, pose);
}

/* Whether the mouse may turn the cone: nothing else moves it. */
static bool is_free(const struct tool *tool)
{
    return tool->held || tool->pointer == POINT_BY_MOUSE || tool->pointer == POINT_BY_WAND ||
           tool->pointer >= POINT_BY_SPACEMOUSE;
}

/* Where the ball is drawn; false where it is not. */
static bool find_ball(float out[2], const struct window *window, enum tool_number number)
{
    const struct cone_sight *sight = &window->pictures.cones[number];
    float entry[2];
    return pane_tool_shows(window, number) && sight->is_seen && is_free(&window->viewer->tools[number]) &&
           window_point(out, window, sight->ball) && window_point(entry, window, sight->extent.entry) &&
           hypotf(out[0] - entry[0], out[1] - entry[1]) > end_on * window->screen.scale;
}

enum tool_number pane_cone_at(const struct window *window, const float at[2])
{
    enum tool_number number = FIRST_TOOL;
    float place[2];
    while (number < TOOL_COUNT && !(find_ball(place, window, number) && hypotf(at[0] - place[0], at[1] - place[1]) <=
                                                                            (ball + grip) * window->screen.scale)) {
        number++;
    }
    return number;
}

void pane_ball_draw(struct window *window, enum tool_number number)
{
    float at[2];
    struct pen pen = pane_tool_pen(window, number);
    const bool is_drawn = find_ball(at, window, number);
    window->pictures.cones[number].has_ball = is_drawn;
    if (is_drawn) {
        const struct ui_mouse mouse = ui_mouse_now();
        bool is_taken =
            window->frame.turns_cone == number || pane_cone_at(window, (float[]){mouse.x, mouse.y}) == number;
        ui_colour inside = pen.colour;
        inside.a = window->pictures.cones[number].hides_ball ? inside.a / 4 : inside.a;
        float half = (ball + grip) * pen.scale;
        labels_reserve(&window->frame.labels, (struct ui_box){at[0] - half, at[1] - half, 2 * half, 2 * half});
        ui_draw_circle(at, ball * pen.scale, inside, 0);
        pen.colour = is_taken ? (ui_colour){LOOK_RGB(LOOK_WHITE), 255} : pen.colour;
        stroke_circle(at, ball, pen);
    }
}

bool pane_cone_turn(struct window *window)
{
    const struct ui_mouse mouse = ui_mouse_now();
    const struct hover *hover = &window->frame.hover;
    struct viewer *viewer = window->viewer;
    struct frame_state *frame = &window->frame;
    if (mouse.pressed[0] && ui_surface_held()) {
        frame->turns_cone = pane_cone_at(window, (float[]){mouse.x, mouse.y});
        if (frame->turns_cone < TOOL_COUNT) {
            struct tool *tool = &viewer->tools[frame->turns_cone];
            frame->turned_about = window->pictures.cones[frame->turns_cone].turned;
            if (tool->pointer == POINT_BY_MOUSE && !tool->held) {
                tool_hold(viewer, frame->turns_cone);
            }
        }
    } else if (!mouse.down[0]) {
        frame->turns_cone = TOOL_COUNT;
    }
    bool turns = frame->turns_cone < TOOL_COUNT;
    if (turns && (mouse.moved_x != 0 || mouse.moved_y != 0)) {
        extent_turn(viewer, frame->turns_cone, &frame->turned_about, hover->eye, hover->direction);
    }
    return turns;
}
