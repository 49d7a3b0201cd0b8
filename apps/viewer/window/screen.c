/* SPDX-License-Identifier: BSD-3-Clause */
/* The screen that the window is on: full screen, and what a tracked head sees through a part of it. */
#include "viewer/window/screen.h"

#include <GLFW/glfw3.h>
#include <string.h>

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

void screen_fit(struct place *place)
{
    int count;
    GLFWmonitor **monitors = glfwGetMonitors(&count);
    int area[4] = {0};
    for (int i = count - 1; i >= 0; i--) { /* or else the first */
        int free[4];
        glfwGetMonitorWorkarea(monitors[i], &free[0], &free[1], &free[2], &free[3]);
        int across = place->x + place->width / 2 - free[0];
        int down = place->y + place->height / 2 - free[1];
        if (i == 0 || (place->known && across >= 0 && across < free[2] && down >= 0 && down < free[3])) {
            memcpy(area, free, sizeof area);
            break;
        }
    }
    if (area[2] > 0 && area[3] > 0) {
        place_fit(place, area);
    }
}

float window_screen_scale(const struct window *window, float content)
{
    int screen[4];
    int millimetres[2];
    GLFWmonitor *monitor = window_screen(window, screen);
    if (!monitor) {
        return content;
    }
    glfwGetMonitorPhysicalSize(monitor, &millimetres[0], &millimetres[1]);
    return place_scale(content, screen[2], millimetres[0]);
}

void window_fill_screen(struct window *window, bool fill)
{
    int screen[4];
    void *monitor = fill ? window_screen(window, screen) : NULL;
    if (fill == window->screen.alone) {
        return;
    }
    if (fill) {
        window_place(window, &window->screen.before);
    }
    window->screen.alone = fill;
    if (monitor) { /* it stays when others are clicked on: who points may stand far from who clicks */
        glfwSetWindowAttrib(window->handle, GLFW_AUTO_ICONIFY, GLFW_FALSE);
        glfwSetWindowMonitor(window->handle, monitor, 0, 0, screen[2], screen[3], GLFW_DONT_CARE);
    } else if (!fill) {
        const struct place *place = &window->screen.before;
        glfwSetWindowMonitor(window->handle, NULL, place->x, place->y, place->width, place->height, 0);
    }
    window->viewer->version++;
}

/* Left, right, lower and upper edge of a box of the window, in parts of the screen. */
static void find_part(double part[4], const struct window *window, const struct ui_box *box)
{
    int place[4];
    int screen[4];
    glfwGetWindowPos(window->handle, &place[0], &place[1]);
    glfwGetWindowSize(window->handle, &place[2], &place[3]);
    if (!window_screen(window, screen)) {
        memcpy(part, (double[]){0, 1, 0, 1}, 4 * sizeof *part);
        return;
    }
    double unit = (double)place[2] / window->screen.width; /* the screen's, per pixel */
    double left = place[0] - screen[0] + unit * (double)box->x;
    double top = place[1] - screen[1] + unit * (double)box->y;
    part[0] = left / screen[2];
    part[1] = (left + unit * (double)box->width) / screen[2];
    part[2] = 1 - (top + unit * (double)box->height) / screen[3];
    part[3] = 1 - top / screen[3];
}

void window_sight(const struct window *window, struct sight *out)
{
    const struct viewer *viewer = window->viewer;
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    double part[4];
    if (viewer->head.on && window->screen.width > 0) {
        find_part(part, window, box);
        if (head_sight(out, &viewer->head, part)) {
            return;
        }
    }
    sight_of_orbit(out, &viewer->orbit, (double[]){(double)box->width, (double)box->height});
}
