/* SPDX-License-Identifier: BSD-3-Clause */
/* Which way the 3-D pane looks: a small cross of the directions L R P A I S, as conus render draws it. */
#include "viewer/panes/panes.h"

static const ui_colour near = {235, 235, 240, 255};
static const ui_colour far = {175, 175, 181, 255};
static const ui_colour edge = {20, 20, 24, 190};

/* Half an axis; what points away from the viewer is paler. */
static void draw_direction(const struct window *window, const float centre[2], size_t axis, int sign)
{
    static const char letters[3][2][2] = {{"L", "R"}, {"P", "A"}, {"I", "S"}};
    const double *m = window->pictures.sight.camera.world_from_device;
    float x = (float)(sign * m[axis]);
    float y = (float)(-sign * m[4 + axis]);
    bool is_away = sign * m[8 + axis] < 0;
    float length = 1.5F * ui_line();
    const float end[2] = {centre[0] + length * x, centre[1] + length * y};
    const char *letter = letters[axis][sign > 0];
    ui_draw_line(centre, end, edge, is_away ? 2.5F : 3.5F);
    ui_draw_line(centre, end, is_away ? far : near, is_away ? 1.0F : 2.0F);
    if (x * x + y * y > 0.1F) { /* else it points at the viewer, or away */
        const float at[2] = {centre[0] + 1.45F * length * x - ui_text_width(letter) / 2,
                             centre[1] + 1.45F * length * y - ui_line() / 2};
        ui_draw_text(at, is_away ? far : near, letter);
    }
}

void pane_compass(const struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    float reach = 2.9F * ui_line();
    bool is_well;
    bool has_text = head_text(&window->viewer->head, &is_well) || !window->viewer->tools[FIRST_TOOL].has_pose;
    float below = has_text ? 1.6F * ui_line() : 0; /* where it stands */
    const float centre[2] = {box->x + box->width - reach, box->y + box->height - reach - below};
    if (box->width > 3 * reach && box->height > 4 * reach) {
        for (int half = 0; half < 12; half++) { /* what points away first */
            size_t axis = (size_t)half % 3;
            int sign = half / 3 % 2 ? 1 : -1;
            bool is_away = sign * window->pictures.sight.camera.world_from_device[8 + axis] < 0;
            if (is_away == (half < 6)) {
                draw_direction(window, centre, axis, sign);
            }
        }
    }
}
