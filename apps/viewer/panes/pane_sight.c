/* SPDX-License-Identifier: BSD-3-Clause */
/* What the 3-D pane shows: its own eye's view or, of a tracked head, that through the part of the screen which it is.
 */
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <string.h>

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
    double unit = (double)place[2] / window->width; /* the screen's, per pixel */
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
    const struct ui_box *box = &window->panes[PANE_3D];
    double part[4];
    if (viewer->head.on && window->width > 0) {
        find_part(part, window, box);
        if (head_sight(out, &viewer->head, part)) {
            return;
        }
    }
    sight_of_orbit(out, &viewer->orbit, (double[]){(double)box->width, (double)box->height});
}
