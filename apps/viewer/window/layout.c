/* SPDX-License-Identifier: BSD-3-Clause */
/* Widths and parts within their limits. */
#include "viewer/window/layout.h"

#include <math.h>
#include <stddef.h>

static const double first_panels[2] = {250, 480};
static const double first_panes = 550;                   /* at least, where they have it */
static const double first_parts[2] = {1 / 4.0, 1 / 3.0}; /* of the window's width, at most, of these */
static const double least_panel = 240, most_panel = 4000;
static const double most_part = 0.4; /* of the window's width, of each panel */
static const double least_division = 0.1, most_division = 0.9;
static const double division_step = 0.05, panel_step = 20;

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

/* The width of a panel. The right one at first leaves the panes the width that they need, where it can. */
static float panel_width(const struct layout *layout, size_t side, float width, float scale)
{
    double own = layout->panels[side];
    double wanted = (own > 0 ? own : first_panels[side]) * (double)scale;
    double most = (double)width * (own > 0 ? most_part : first_parts[side]);
    if (side == 1 && !(own > 0)) {
        most = fmax(most, (double)(width - panel_width(layout, 0, width, scale)) - first_panes * (double)scale);
    }
    return floorf((float)fmin(wanted, most));
}

static float first_part(double division, float whole)
{
    return floorf((division > 0 ? (float)division : 0.5F) * whole);
}

struct division layout_divide(const struct layout *layout, float width, float height, float scale)
{
    struct division division = {.left = panel_width(layout, 0, width, scale),
                                .right = panel_width(layout, 1, width, scale)};
    division.columns = 2 * floorf((width - division.left - division.right) / 2);
    division.rows = 2 * floorf(height / 2);
    division.column = first_part(layout->division[0], division.columns);
    division.row = first_part(layout->division[1], division.rows);
    return division;
}

static void set_panel(struct layout *layout, size_t side, double wide, float width, float scale)
{
    double most = fmax(most_part * (double)width / (double)scale, least_panel);
    layout->panels[side] = clamp(wide, least_panel, fmin(most, most_panel));
}

static void set_division(struct layout *layout, size_t axis, double part)
{
    layout->division[axis] = clamp(part, least_division, most_division);
}

void layout_move(struct layout *layout, enum border border, float at, float width, float height, float scale)
{
    struct division now = layout_divide(layout, width, height, scale);
    if (border == BORDER_LEFT) {
        set_panel(layout, 0, (double)at / (double)scale, width, scale);
    } else if (border == BORDER_RIGHT) {
        set_panel(layout, 1, (double)(width - at) / (double)scale, width, scale);
    } else if (border == BORDER_COLUMN && now.columns > 0) {
        set_division(layout, 0, (double)((at - now.left) / now.columns));
    } else if (border == BORDER_ROW && now.rows > 0) {
        set_division(layout, 1, (double)(at / now.rows));
    }
}

void layout_reset(struct layout *layout, enum border border)
{
    double *const values[BORDER_COUNT] = {&layout->panels[0], &layout->panels[1], &layout->division[0],
                                          &layout->division[1]};
    *values[border] = 0;
}

void layout_widen_first(struct layout *layout, int steps)
{
    for (size_t axis = 0; axis < 2; axis++) {
        double now = layout->division[axis] > 0 ? layout->division[axis] : 0.5;
        set_division(layout, axis, now + steps * division_step);
    }
}

void layout_widen_panels(struct layout *layout, int steps, float width, float scale)
{
    const float now[2] = {panel_width(layout, 0, width, scale), panel_width(layout, 1, width, scale)};
    for (size_t side = 0; side < 2; side++) {
        set_panel(layout, side, (double)(now[side] / scale) + steps * panel_step, width, scale);
    }
}

bool layout_is_same(const struct layout *a, const struct layout *b)
{
    return a->panels[0] == b->panels[0] && a->panels[1] == b->panels[1] && a->division[0] == b->division[0] &&
           a->division[1] == b->division[1];
}

bool layout_is_fine(const struct layout *layout)
{
    bool fine = true;
    for (size_t i = 0; i < 2; i++) {
        double panel = layout->panels[i];
        double division = layout->division[i];
        fine = fine && (panel == 0 || (panel >= least_panel && panel <= most_panel)) &&
               (division == 0 || (division >= least_division && division <= most_division));
    }
    return fine;
}
