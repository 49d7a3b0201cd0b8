/* SPDX-License-Identifier: BSD-3-Clause */
/* The screen that the window is on, and full screen. */
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>

void *window_screen(const struct window *window, int screen[4])
{
    int count;
    int place[4];
    GLFWmonitor **monitors = glfwGetMonitors(&count);
    glfwGetWindowPos(window->handle, &place[0], &place[1]);
    glfwGetWindowSize(window->handle, &place[2], &place[3]);
    for (int i = count - 1; i >= 0; i--) { /* or else the first */
        const GLFWvidmode *mode = glfwGetVideoMode(monitors[i]);
        int x, y;
        glfwGetMonitorPos(monitors[i], &x, &y);
        int across = place[0] + place[2] / 2 - x;
        int down = place[1] + place[3] / 2 - y;
        if (mode && (i == 0 || (across >= 0 && across < mode->width && down >= 0 && down < mode->height))) {
            screen[0] = x;
            screen[1] = y;
            screen[2] = mode->width;
            screen[3] = mode->height;
            return monitors[i];
        }
    }
    return NULL;
}

void window_fill_screen(struct window *window, bool fill)
{
    int screen[4];
    void *monitor = fill ? window_screen(window, screen) : NULL;
    if (fill == window->alone) {
        return;
    }
    if (fill) {
        window_place(window, &window->before);
    }
    window->alone = fill;
    if (monitor) { /* it stays when others are clicked on: who points may stand far from who clicks */
        glfwSetWindowAttrib(window->handle, GLFW_AUTO_ICONIFY, GLFW_FALSE);
        glfwSetWindowMonitor(window->handle, monitor, 0, 0, screen[2], screen[3], GLFW_DONT_CARE);
    } else if (!fill) {
        const struct place *place = &window->before;
        glfwSetWindowMonitor(window->handle, NULL, place->x, place->y, place->width, place->height, 0);
    }
    window->viewer->version++;
}
