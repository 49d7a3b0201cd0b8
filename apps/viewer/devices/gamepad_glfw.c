/* SPDX-License-Identifier: BSD-3-Clause */
/* The first gamepad of GLFW. */
#include "viewer/devices/gamepad.h"

#include <GLFW/glfw3.h>

static void take(struct gamepad_reading *out, const GLFWgamepadstate *state)
{
    const unsigned char *buttons = state->buttons;
    *out = (struct gamepad_reading){
        .presence = GAMEPAD_THERE,
        .left = {(double)state->axes[GLFW_GAMEPAD_AXIS_LEFT_X], (double)state->axes[GLFW_GAMEPAD_AXIS_LEFT_Y]},
        .right = {(double)state->axes[GLFW_GAMEPAD_AXIS_RIGHT_X], (double)state->axes[GLFW_GAMEPAD_AXIS_RIGHT_Y]},
        .triggers = {(1 + (double)state->axes[GLFW_GAMEPAD_AXIS_LEFT_TRIGGER]) / 2,
                     (1 + (double)state->axes[GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER]) / 2},
        .up = buttons[GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER],
        .down = buttons[GLFW_GAMEPAD_BUTTON_LEFT_BUMPER],
        .pressed = (buttons[GLFW_GAMEPAD_BUTTON_A] ? SOURCE_HOLD : 0U) |
                   (buttons[GLFW_GAMEPAD_BUTTON_B] ? SOURCE_RESET : 0U) |
                   (buttons[GLFW_GAMEPAD_BUTTON_X] ? SOURCE_CONFIRM : 0U)};
}

void gamepad_read(struct gamepad_reading *out)
{
    GLFWgamepadstate state;
    *out = (struct gamepad_reading){.presence = GAMEPAD_NONE};
    for (int joystick = GLFW_JOYSTICK_1; joystick <= GLFW_JOYSTICK_LAST; joystick++) {
        if (glfwJoystickIsGamepad(joystick) && glfwGetGamepadState(joystick, &state)) {
            take(out, &state);
            return;
        }
        if (glfwJoystickPresent(joystick)) {
            out->presence = GAMEPAD_UNKNOWN;
        }
    }
}
