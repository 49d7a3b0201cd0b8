/* SPDX-License-Identifier: BSD-3-Clause */
/* The walk of one ray through the cells of a volume: to the first object, or through all of them. */
#include "selection/engine/voxels/traverse.h"

#include "base/geometry/math3.h"

#include <math.h>

/* A ray's step into the next cell along an axis. */
struct cell_step {
    double t;
    int axis;
};

double traverse_cell(double x)
{
    double cell = floor(x + 0.5);
    if (cell - 0.5 > x) { /* x + 0.5 was rounded up */
        return cell - 1;
    }
    return cell + 0.5 <= x ? cell + 1 : cell;
}

/* Voxels per mm below which an axis stands still: there is no grid in which it could move by a voxel. */
static const double SLOWEST = 0x1p-900;

void traverse_ray_init(struct traverse_ray *out, const double origin[3], const double direction[3])
{
    for (int a = 0; a < 3; a++) {
        bool moves = fabs(direction[a]) >= SLOWEST;
        out->origin[a] = moves ? origin[a] : traverse_cell(origin[a]);
        out->direction[a] = moves ? direction[a] : 0;
        out->inverse[a] = moves ? 1 / direction[a] : INFINITY;
        out->sign[a] = moves && direction[a] < 0 ? -1 : 1;
    }
}

/* Eq. 5: when the ray leaves the cell (or, with a negative half, enters it). */
static double face_time(const struct traverse_ray *ray, int a, double cell, double half)
{
    return ((cell + half * ray->sign[a]) - ray->origin[a]) * ray->inverse[a];
}

static double exit_time(const struct traverse_ray *ray, int a, double cell)
{
    return face_time(ray, a, cell, 0.5);
}

static double entry_time(const struct traverse_ray *ray, int a, double cell)
{
    return face_time(ray, a, cell, -0.5);
}

static bool is_before(double t, int axis, struct cell_step step)
{
    return t < step.t || (t == step.t && axis < step.axis);
}

/* The cell of `axis` in which the ray is just after the step along another axis, when it was in `from` some time
 * before; past `end`, the first cell beyond the map's box in the ray's direction, it does not look. */
static double cell_after(const struct traverse_ray *ray, int axis, struct cell_step step, double from, double end)
{
    double sign = ray->sign[axis];
    double guess = floor(ray->origin[axis] + step.t * ray->direction[axis] + 0.5);
    guess = sign > 0 ? fmin(fmax(guess, from), end) : fmax(fmin(guess, from), end);
    while (guess != from && !is_before(entry_time(ray, axis, guess), axis, step)) {
        guess -= sign;
    }
    while (guess != end && is_before(exit_time(ray, axis, guess), axis, step)) {
        guess += sign;
    }
    return guess;
}

/* The first cell beyond the map's box in the ray's direction. */
static double end_of(const struct distance_map *map, const struct traverse_ray *ray, int a)
{
    return ray->sign[a] > 0 ? map->last[a] + 1 : map->first[a] - 1;
}

/* Moves all axes but that of the step to where they are after it. */
static void catch_up(const struct distance_map *map, const struct traverse_ray *ray, struct cell_step step,
                     double cell[3])
{
    for (int a = 0; a < 3; a++) {
        if (a != step.axis) {
            cell[a] = cell_after(ray, a, step, cell[a], end_of(map, ray, a));
        }
    }
}

static bool is_inside(const struct distance_map *map, const double cell[3])
{
    for (int a = 0; a < 3; a++) {
        if (!(cell[a] >= map->first[a] && cell[a] <= map->last[a])) {
            return false;
        }
    }
    return true;
}

bool traverse_enter(const struct distance_map *map, const struct traverse_ray *ray, struct traverse_place *out)
{
    struct cell_step last = {.t = 0, .axis = -1};
    for (int a = 0; a < 3; a++) {
        out->cell[a] = traverse_cell(ray->origin[a]);
        double face = ray->sign[a] > 0 ? map->first[a] : map->last[a];
        if ((face - out->cell[a]) * ray->sign[a] > 0) {
            double entry = entry_time(ray, a, face);
            if (entry >= last.t) {
                last = (struct cell_step){.t = entry, .axis = a};
            }
            out->cell[a] = face;
        }
    }
    out->t = last.t + 0.0; /* -0 becomes 0 */
    if (last.axis >= 0 && last.t < INFINITY) {
        catch_up(map, ray, last, out->cell);
    }
    return last.t < INFINITY && is_inside(map, out->cell);
}

bool traverse_skip(const struct distance_map *map, const struct traverse_ray *ray, double radius,
                   struct traverse_place *place)
{
    struct cell_step first = {.t = INFINITY, .axis = 0};
    for (int a = 0; a < 3; a++) {
        double t = exit_time(ray, a, place->cell[a] + radius * ray->sign[a]);
        if (t < first.t) {
            first = (struct cell_step){.t = t, .axis = a};
        }
    }
    place->t = first.t + 0.0; /* -0 becomes 0 */
    place->cell[first.axis] += (radius + 1) * ray->sign[first.axis];
    if (first.t < INFINITY) {
        catch_up(map, ray, first, place->cell);
    }
    return first.t < INFINITY && is_inside(map, place->cell);
}

struct traverse_contact traverse_one(const struct distance_map *map, const struct traverse_ray *ray, double limit)
{
    struct traverse_place at;
    bool inside = traverse_enter(map, ray, &at);
    while (inside && at.t <= limit) {
        int code = traverse_code(map, &at);
        if (code <= 0) {
            uint32_t object = map->least + map->shift + (uint32_t)code;
            return (struct traverse_contact){.t = at.t, .voxel = traverse_voxel(map, &at), .object = object};
        }
        inside = traverse_skip(map, ray, code - 1, &at);
    }
    return (struct traverse_contact){.t = INFINITY, .voxel = UINT64_MAX};
}

/* Ends the interval at t, where the ray comes into a cell of `object`, and begins that one's. */
static conus_status change_object(struct layers *out, conus_interval *interval, uint32_t object, double t,
                                  uint64_t voxel)
{
    conus_status status = CONUS_OK;
    if (interval->object) {
        interval->exit = t;
        status = layers_add(out, interval);
    }
    interval->object = object;
    interval->entry = t;
    interval->voxel = voxel;
    return status;
}

conus_status traverse_pierce(struct layers *out, const struct distance_map *map, const struct volume *volume,
                             const struct traverse_ray *ray, double limit, uint32_t pixel)
{
    conus_status status = CONUS_OK;
    conus_interval interval = {.pixel = pixel};
    struct traverse_place at;
    bool inside = traverse_enter(map, ray, &at);
    while (inside && at.t <= limit && !status) {
        int code = traverse_code(map, &at);
        size_t voxel = traverse_voxel(map, &at);
        uint32_t object = code ? 0 : volume_occupant(volume, voxel);
        if (object != interval.object) {
            status = change_object(out, &interval, object, at.t, voxel);
        }
        inside = traverse_skip(map, ray, code ? code - 1 : 0, &at);
    }
    return status ? status : change_object(out, &interval, 0, at.t, 0);
}

struct traverse_ray traverse_bundle_at(const struct traverse_bundle *bundle, size_t i)
{
    struct traverse_ray ray;
    double direction[3] = {bundle->direction[0][i], bundle->direction[1][i], bundle->direction[2][i]};
    mat4_direction(direction, bundle->index_from_world, direction);
    const double apart[3] = {bundle->starts[0][i], bundle->starts[1][i], bundle->starts[2][i]};
    traverse_ray_init(&ray, bundle->is_apart ? apart : bundle->start, direction);
    return ray;
}

void traverse_bundle_ray(const struct distance_map *map, struct traverse_bundle *bundle, size_t i)
{
    struct traverse_ray ray = traverse_bundle_at(bundle, i);
    struct traverse_contact contact = traverse_one(map, &ray, bundle->limit[i]);
    bundle->t[i] = contact.t;
    bundle->voxel[i] = contact.voxel;
    bundle->object[i] = contact.object;
}
