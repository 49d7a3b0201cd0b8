/* SPDX-License-Identifier: BSD-3-Clause */
/* Grey values of the context in the cuts: dragged, reset, and shown in numbers. */
#include "viewer/panes/panes.h"

#include <math.h>
#include <stdio.h>

static const ui_colour light = {235, 235, 240, 255};

static const double pixels = 300; /* of the mouse's way, for a step of 1 as look_move_grey() has it */

bool pane_grey_drag(struct window *window, const struct ui_mouse *mouse)
{
    struct viewer *viewer = window->viewer;
    bool by_mouse = mouse->down[2] || (mouse->down[0] && mouse->control);
    bool has_grey = viewer->drawn->window[1] > viewer->drawn->window[0];
    if (!has_grey || !ui_surface_held() || !by_mouse) {
        return false;
    }
    if (mouse->doubled_middle || (mouse->doubled && mouse->control)) {
        viewer_set_grey(viewer, 0, 0);
    } else if (mouse->moved_x != 0 || mouse->moved_y != 0) {
        viewer_move_grey(viewer, (double)mouse->moved_x / pixels, -(double)mouse->moved_y / pixels);
    }
    return true;
}

void pane_grey_show(const struct window *window, const struct ui_box *box)
{
    const struct view_atlas *on = window->viewer->drawn;
    const double *grey = view_atlas_grey(on);
    char text[96];
    if (grey != on->window) {
        snprintf(text, sizeof text, "black %.6g  white %.6g", grey[0], grey[1]);
        ui_draw_text((float[]){box->x + 8, box->y + box->height - 1.4F * ui_line()}, light, text);
    }
}
