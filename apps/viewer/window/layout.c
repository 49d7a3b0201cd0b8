/* SPDX-License-Identifier: BSD-3-Clause */
/* Widths and parts within their limits. */
#include "viewer/window/window.h"

#include <math.h>
#include <stddef.h>

static const double first_panels[2] = {250, 480};
static const double first_parts[2] = {1 / 4.0, 0.3}; /* of the window's width, at most, of these */
static const double narrow = 1500;                   /* below that width the left panel is folded at first */
static const double first_division[2] = {0.72, 1 / 3.0};
static const double least_panel = 240, most_panel = 4000;
static const double most_part = 0.4;      /* of the window's width, of each panel */
static const double roomy_part = 3 / 8.0; /* of which beside a rail the panel of hits leaves enough for the brain */
static const double least_division = 0.1, most_division = 0.9;
static const double division_step = 0.05, panel_step = 20;

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

static bool is_folded(const struct layout *layout, size_t side, float width, float scale)
{
    bool at_first = side == 0 && !(layout->panels[0] > 0) && (double)(width / scale) < narrow;
    return layout->folds[side] == FOLD_AS_AT_FIRST ? at_first : layout->folds[side] == FOLD_CLOSED;
}

/* What a panel has at first at most: its part of the window. Where texts are large, names need more than that: beside a
 * rail the panel of hits is then as wide as one that the user made as narrow as can be, if the brain has room, too. */
static double most_at_first(const struct layout *layout, size_t side, float width, float scale)
{
    const double least = least_panel * (double)scale;
    const double part = (double)width * first_parts[side];
    bool has_room = side == 1 && is_folded(layout, 0, width, scale) && least <= (double)width * roomy_part;
    return has_room ? fmax(part, least) : part;
}

static float panel_width(const struct layout *layout, size_t side, float width, float scale)
{
    double own = layout->panels[side];
    double wanted = (own > 0 ? own : first_panels[side]) * (double)scale;
    double most = own > 0 ? (double)width * most_part : most_at_first(layout, side, width, scale);
    if (is_folded(layout, side, width, scale)) {
        return floorf(LAYOUT_RAIL * scale);
    }
    return floorf((float)fmin(wanted, most));
}

static float first_part(const struct layout *layout, size_t axis, float whole)
{
    double own = layout->division[axis];
    return floorf((float)(own > 0 ? own : first_division[axis]) * whole);
}

struct division layout_divide(const struct layout *layout, float width, float height, float scale)
{
    struct division division = {.folded = {is_folded(layout, 0, width, scale), is_folded(layout, 1, width, scale)},
                                .left = panel_width(layout, 0, width, scale),
                                .right = panel_width(layout, 1, width, scale)};
    division.columns = 2 * floorf((width - division.left - division.right) / 2);
    division.rows = 2 * floorf(height / 2);
    division.column = first_part(layout, 0, division.columns);
    division.row = first_part(layout, 1, division.rows);
    return division;
}

static void set_panel(struct layout *layout, size_t side, double wide, float width, float scale)
{
    layout->folds[side] = FOLD_OPEN;
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
    set_division(layout, 0,
                 (layout->division[0] > 0 ? layout->division[0] : first_division[0]) + steps * division_step);
}

void layout_fold(struct layout *layout, size_t side, bool fold)
{
    layout->folds[side] = fold ? FOLD_CLOSED : FOLD_OPEN;
}

void layout_widen_panels(struct layout *layout, int steps, float width, float scale)
{
    for (size_t side = 0; side < 2; side++) {
        if (!is_folded(layout, side, width, scale)) {
            double now = (double)(panel_width(layout, side, width, scale) / scale);
            set_panel(layout, side, now + steps * panel_step, width, scale);
        }
    }
}

bool layout_is_same(const struct layout *a, const struct layout *b)
{
    return a->panels[0] == b->panels[0] && a->panels[1] == b->panels[1] && a->division[0] == b->division[0] &&
           a->division[1] == b->division[1] && a->folds[0] == b->folds[0] && a->folds[1] == b->folds[1];
}

bool layout_is_fine(const struct layout *layout)
{
    bool fine = true;
    for (size_t i = 0; i < 2; i++) {
        double panel = layout->panels[i];
        double division = layout->division[i];
        fine = fine && layout->folds[i] < FOLD_COUNT && (panel == 0 || (panel >= least_panel && panel <= most_panel)) &&
               (division == 0 || (division >= least_division && division <= most_division));
    }
    return fine;
}
