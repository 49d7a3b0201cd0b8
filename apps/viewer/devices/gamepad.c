/* SPDX-License-Identifier: BSD-3-Clause */
/* Turns the sticks, which GLFW reads, into moves. */
#include "viewer/devices/devices.h"

#include <GLFW/glfw3.h>
#include <math.h>

static const double dead_stick = 0.15, dead_trigger = 0.05; /* nobody touches it: so far they may be off */
static const double longest_s = 0.05;                       /* between two questions, as far as moves count */
static const double doubling_s = 1;                         /* a full trigger doubles or halves the angle */

/* Scales a stick by its length: 0 in the dead zone, then 0 to 1 from its edge on, in every direction. */
static void free_stick(double out[2], const double stick[2])
{
    double length = hypot(stick[0], stick[1]);
    double part = length > dead_stick ? (fmin(length, 1) - dead_stick) / (1 - dead_stick) / length : 0;
    out[0] = isnan(length) ? length : part * stick[0];
    out[1] = isnan(length) ? length : part * stick[1];
}

static double free_trigger(double trigger)
{
    return trigger <= dead_trigger ? 0 : (fmin(trigger, 1) - dead_trigger) / (1 - dead_trigger); /* NaN stays */
}

static void move(const struct gamepad *gamepad, const struct gamepad_reading *reading, double seconds,
                 struct source_update *out)
{
    double left[2];
    double right[2];
    double way = source_speed(&gamepad->source) * seconds;
    double wider = free_trigger(reading->triggers[1]) - free_trigger(reading->triggers[0]);
    free_stick(left, reading->left);
    free_stick(right, reading->right);
    out->move[0] = way * left[0];
    out->move[1] = way * (reading->up - reading->down);
    out->move[2] = way * left[1]; /* away from the user is forward, -z */
    out->turn[0] = -way * right[1] * M_PI / 180;
    out->turn[1] = -way * right[0] * M_PI / 180;
    out->widen = wider != 0 ? exp2(wider * seconds / doubling_s) : 0;
}

static bool ask(struct source *source, double now_s, struct source_update *out, double said[SOURCE_VALUES])
{
    struct gamepad *gamepad = (struct gamepad *)source;
    struct gamepad_reading reading = {.presence = GAMEPAD_NONE};
    double seconds = fmin(fmax(now_s - gamepad->asked_s, 0), longest_s);
    gamepad->asked_s = now_s;
    gamepad->read(&reading);
    if (reading.presence != GAMEPAD_THERE) {
        out->state = SOURCE_ABSENT;
        out->text = reading.presence == GAMEPAD_UNKNOWN ? "a joystick of unknown layout"
                    : gamepad->was_there                ? "the gamepad is unplugged"
                                                        : "no gamepad is plugged in";
        gamepad->pressed = 0;
        return false;
    }
    out->state = SOURCE_WELL;
    const double values[] = {reading.left[0],     reading.left[1],     reading.right[0], reading.right[1],
                             reading.triggers[0], reading.triggers[1], reading.up,       reading.down};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        said[i] = values[i];
    }
    gamepad->was_there = true;
    out->pressed = reading.pressed & ~gamepad->pressed;
    gamepad->pressed = reading.pressed;
    move(gamepad, &reading, seconds, out);
    return out->move[0] != 0 || out->move[1] != 0 || out->move[2] != 0 || out->turn[0] != 0 || out->turn[1] != 0 ||
           out->widen != 0;
}

void gamepad_init(struct gamepad *out, void (*read)(struct gamepad_reading *reading))
{
    *out = (struct gamepad){.source = {.ask = ask, .speed = SOURCE_SPEED}, .read = read};
}

void gamepad_read(struct gamepad_reading *out)
{
    GLFWgamepadstate state;
    *out = (struct gamepad_reading){.presence = GAMEPAD_NONE};
    for (int joystick = GLFW_JOYSTICK_1; joystick <= GLFW_JOYSTICK_LAST; joystick++) {
        if (glfwJoystickIsGamepad(joystick) && glfwGetGamepadState(joystick, &state)) {
            const float *axes = state.axes;
            const unsigned char *buttons = state.buttons;
            *out = (struct gamepad_reading){
                .presence = GAMEPAD_THERE,
                .left = {(double)axes[GLFW_GAMEPAD_AXIS_LEFT_X], (double)axes[GLFW_GAMEPAD_AXIS_LEFT_Y]},
                .right = {(double)axes[GLFW_GAMEPAD_AXIS_RIGHT_X], (double)axes[GLFW_GAMEPAD_AXIS_RIGHT_Y]},
                .triggers = {(1 + (double)axes[GLFW_GAMEPAD_AXIS_LEFT_TRIGGER]) / 2,
                             (1 + (double)axes[GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER]) / 2},
                .up = buttons[GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER],
                .down = buttons[GLFW_GAMEPAD_BUTTON_LEFT_BUMPER],
                .pressed = (buttons[GLFW_GAMEPAD_BUTTON_A] ? SOURCE_HOLD : 0U) |
                           (buttons[GLFW_GAMEPAD_BUTTON_B] ? SOURCE_RESET : 0U) |
                           (buttons[GLFW_GAMEPAD_BUTTON_X] ? SOURCE_CONFIRM : 0U)};
            return;
        }
        if (glfwJoystickPresent(joystick)) {
            out->presence = GAMEPAD_UNKNOWN;
        }
    }
}
