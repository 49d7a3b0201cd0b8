/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/traverse.h"

#include <math.h>

double traverse_cell(double x)
{
    double cell = floor(x + 0.5);
    if (cell - 0.5 > x) { /* x + 0.5 was rounded up */
        return cell - 1;
    }
    return cell + 0.5 <= x ? cell + 1 : cell;
}

void traverse_ray_init(struct traverse_ray *out, const double origin[3], const double direction[3])
{
    for (int a = 0; a < 3; a++) {
        double inverse = 1 / direction[a];
        bool moves = isfinite(inverse);
        out->origin[a] = moves ? origin[a] : traverse_cell(origin[a]);
        out->direction[a] = moves ? direction[a] : 0;
        out->inverse[a] = moves ? inverse : INFINITY;
        out->sign[a] = moves && direction[a] < 0 ? -1 : 1;
    }
}

/* Eq. 5: when the ray leaves the cell (or, with a negative half, enters it). */
static double crossing_time(const struct traverse_ray *ray, int a, double cell, double half)
{
    return ((cell + half * ray->sign[a]) - ray->origin[a]) * ray->inverse[a];
}

static double exit_time(const struct traverse_ray *ray, int a, double cell)
{
    return crossing_time(ray, a, cell, 0.5);
}

static double entry_time(const struct traverse_ray *ray, int a, double cell)
{
    return crossing_time(ray, a, cell, -0.5);
}

static bool is_before(double t, int axis, struct traverse_crossing crossing)
{
    return t < crossing.t || (t == crossing.t && axis < crossing.axis);
}

double traverse_cell_after(const struct traverse_ray *ray, int axis, struct traverse_crossing crossing, double from,
                           double end)
{
    double sign = ray->sign[axis];
    double guess = floor(ray->origin[axis] + crossing.t * ray->direction[axis] + 0.5);
    guess = sign > 0 ? fmin(fmax(guess, from), end) : fmax(fmin(guess, from), end);
    while (guess != from && !is_before(entry_time(ray, axis, guess), axis, crossing)) {
        guess -= sign;
    }
    while (guess != end && is_before(exit_time(ray, axis, guess), axis, crossing)) {
        guess += sign;
    }
    return guess;
}

/* The first cell beyond the grid in the ray's direction. */
static double end_of(const struct leap_map *map, const struct traverse_ray *ray, int a)
{
    return ray->sign[a] > 0 ? (double)map->dim[a] : -1;
}

/* Moves all axes but that of the crossing to where they are after it. */
static void catch_up(const struct leap_map *map, const struct traverse_ray *ray, struct traverse_crossing crossing,
                     double cell[3])
{
    for (int a = 0; a < 3; a++) {
        if (a != crossing.axis) {
            cell[a] = traverse_cell_after(ray, a, crossing, cell[a], end_of(map, ray, a));
        }
    }
}

static bool is_inside(const struct leap_map *map, const double cell[3])
{
    for (int a = 0; a < 3; a++) {
        if (!(cell[a] >= 0 && cell[a] < (double)map->dim[a])) {
            return false;
        }
    }
    return true;
}

/* The ray's first cell in the grid: its origin's, or that behind the last crossing that brings it in. */
static bool enter_grid(const struct leap_map *map, const struct traverse_ray *ray, double cell[3], double *t)
{
    struct traverse_crossing last = {.t = 0, .axis = -1};
    for (int a = 0; a < 3; a++) {
        cell[a] = traverse_cell(ray->origin[a]);
        double first = ray->sign[a] > 0 ? 0 : (double)map->dim[a] - 1;
        if ((first - cell[a]) * ray->sign[a] > 0) {
            double entry = entry_time(ray, a, first);
            if (entry >= last.t) {
                last = (struct traverse_crossing){.t = entry, .axis = a};
            }
            cell[a] = first;
        }
    }
    if (last.axis >= 0 && last.t < INFINITY) {
        catch_up(map, ray, last, cell);
    }
    *t = last.t;
    return last.t < INFINITY && is_inside(map, cell);
}

/* Leaves the box of @p radius cells around the cell; all of it is empty. */
static struct traverse_crossing leap(const struct leap_map *map, const struct traverse_ray *ray, double radius,
                                     double cell[3])
{
    struct traverse_crossing first = {.t = INFINITY, .axis = 0};
    for (int a = 0; a < 3; a++) {
        double t = exit_time(ray, a, cell[a] + radius * ray->sign[a]);
        if (t < first.t) {
            first = (struct traverse_crossing){.t = t, .axis = a};
        }
    }
    cell[first.axis] += (radius + 1) * ray->sign[first.axis];
    if (first.t < INFINITY) {
        catch_up(map, ray, first, cell);
    }
    return first;
}

struct traverse_contact traverse_one(const struct leap_map *map, const struct traverse_ray *ray, double limit)
{
    struct traverse_contact none = {.t = INFINITY, .voxel = UINT64_MAX};
    double cell[3];
    double t;
    if (!enter_grid(map, ray, cell, &t)) {
        return none;
    }
    while (t <= limit && t < INFINITY && is_inside(map, cell)) {
        size_t i = (size_t)cell[0];
        size_t j = (size_t)cell[1];
        size_t k = (size_t)cell[2];
        uint8_t code = map->codes[leap_map_at(map, i, j, k)];
        if (!code) {
            return (struct traverse_contact){.t = t, .voxel = i + map->dim[0] * (j + map->dim[1] * k)};
        }
        t = leap(map, ray, code - 1, cell).t;
    }
    return none;
}
