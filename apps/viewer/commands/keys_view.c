/* SPDX-License-Identifier: BSD-3-Clause */
/* The 3-D view and the crosshair, moved by keys. */
#include "viewer/commands/keys_view.h"

#include <math.h>
#include <strings.h>

static const double turn_step = 0.025; /* of a pane's height: 5 degrees */

enum move { TURN, ZOOM, CROSS, MAGNIFY };

static const struct {
    const char *key;
    enum move move;
    double right, up, superior; /* or clicks of a wheel, in up */
} keys[] = {
    {"left", TURN, -1, 0, 0},
    {"right", TURN, 1, 0, 0},
    {"up", TURN, 0, 1, 0},
    {"down", TURN, 0, -1, 0},
    {"pageup", ZOOM, 0, 1, 0},
    {"pagedown", ZOOM, 0, -1, 0},
    {"shift+left", CROSS, -1, 0, 0},
    {"shift+right", CROSS, 1, 0, 0},
    {"shift+up", CROSS, 0, 1, 0},
    {"shift+down", CROSS, 0, -1, 0},
    {"shift+pageup", CROSS, 0, 0, 1},
    {"shift+pagedown", CROSS, 0, 0, -1},
    {"ctrl+pageup", MAGNIFY, 0, 1, 0},
    {"ctrl+pagedown", MAGNIFY, 0, -1, 0},
};
enum { KEYS = sizeof keys / sizeof keys[0] };

/* By 1 mm; to the right as the cuts show it. */
static void move_cross(struct viewer *viewer, double right, double up, double superior)
{
    double side = viewer->display.radiological ? -1 : 1;
    const double at[3] = {viewer->crosshair[0] + side * right, viewer->crosshair[1] + up,
                          viewer->crosshair[2] + superior};
    viewer_cross(viewer, at);
}

static void turn(struct viewer *viewer, double right, double up)
{
    if (viewer->head.on) {
        viewer_say(viewer, "the head moves the view; T gives it to the mouse");
    } else {
        orbit_turn(&viewer->orbit, turn_step * right, -turn_step * up, 1);
        viewer->version++;
    }
}

bool keys_view_press(struct window *window, const char *key)
{
    struct viewer *viewer = window->viewer;
    size_t i = 0;
    while (i < KEYS && strcasecmp(keys[i].key, key) != 0) {
        i++;
    }
    if (i == KEYS) {
        return false;
    }
    switch (keys[i].move) {
    case TURN:
        turn(viewer, keys[i].right, keys[i].up);
        break;
    case ZOOM:
        orbit_zoom(&viewer->orbit, keys[i].up);
        viewer->version++;
        break;
    case CROSS:
        move_cross(viewer, keys[i].right, keys[i].up, keys[i].superior);
        break;
    case MAGNIFY:
        viewer->magnification = fmin(fmax(viewer->magnification * pow(1.1, keys[i].up), 0.2), 50);
        viewer->version++;
        break;
    }
    return true;
}

const char *keys_view_name(const char **meaning, size_t index)
{
    static const char *const names[][2] = {
        {"Arrows", "turn the 3-D view by 5\u00b0; the wand, where that points"},
        {"Page Up, Down", "come nearer in 3-D, or go away"},
        {"Shift+arrows", "the crosshair: 1 mm to the side, to the front or back"},
        {"Shift+Page ...", "the crosshair: 1 mm up, down"},
        {"Ctrl+Page ...", "magnify the cuts, or less"},
    };
    if (index >= sizeof names / sizeof names[0]) {
        return NULL;
    }
    *meaning = names[index][1];
    return names[index][0];
}
