/* SPDX-License-Identifier: BSD-3-Clause */
/* The borders between panels and panes, which the mouse drags. */
#include "viewer/panes/panes.h"

#include "base/look.h"

#include <math.h>

static const ui_colour light = {LOOK_RGB(LOOK_BORDER), 200};
static const float thick = 6; /* where the mouse meets it, at scale 1 */

/* Finds the box in which the mouse meets a border; false where there is no border. */
static bool find_box(struct ui_box *out, const struct window *window, enum border border)
{
    float height = window->screen.status.y;
    float width = (float)window->screen.width;
    struct division d = layout_divide(&window->screen.layout, width, height, window->screen.scale);
    float edge = floorf(thick * window->screen.scale);
    float at[] = {d.left, width - d.right, d.left + d.column, d.row};
    *out = border == BORDER_ROW ? (struct ui_box){d.left + d.column, at[border] - edge / 2, d.columns - d.column, edge}
                                : (struct ui_box){at[border] - edge / 2, 0, edge, height};
    return !screen_is_bare(&window->screen) && (border < BORDER_COLUMN || window->screen.enlarged < 0);
}

static void use_mouse(struct window *window, enum border border)
{
    struct ui_mouse mouse = ui_mouse_now();
    if (mouse.doubled) {
        layout_reset(&window->screen.layout, border);
    } else if (ui_surface_held() && (mouse.moved_x != 0 || mouse.moved_y != 0)) {
        layout_move(&window->screen.layout, border, border == BORDER_ROW ? mouse.y : mouse.x,
                    (float)window->screen.width, window->screen.status.y, window->screen.scale);
    }
}

void pane_borders(struct window *window)
{
    static const char *const ids[] = {"border left", "border right", "border column", "border row"};
    for (int i = BORDER_COUNT - 1; i >= 0; i--) {
        enum border border = (enum border)i;
        struct ui_box box;
        if (!find_box(&box, window, border)) {
            continue;
        }
        ui_panel(ids[i], box, UI_PLAIN);
        if (ui_surface("surface", box)) {
            use_mouse(window, border);
            ui_resize_pointer(border == BORDER_ROW);
            struct ui_box third = border == BORDER_ROW
                                      ? (struct ui_box){box.x, box.y + box.height / 3, box.width, box.height / 3}
                                      : (struct ui_box){box.x + box.width / 3, box.y, box.width / 3, box.height};
            ui_draw_box(third, light, 0);
            ui_tip("drag it; a double click puts it back");
        }
        ui_panel_end();
    }
}
