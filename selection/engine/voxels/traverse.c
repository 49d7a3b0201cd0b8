/* SPDX-License-Identifier: BSD-3-Clause */
/* The walk of one ray through the cells of a volume, and the choice of a kernel for bundles. */
#include "selection/engine/voxels/traverse.h"

#include "base/geometry/math3.h"
#include "base/simd/processor.h"

#include <math.h>

/* After it the ray is in the next cell of the axis. */
struct crossing {
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

static bool is_before(double t, int axis, struct crossing crossing)
{
    return t < crossing.t || (t == crossing.t && axis < crossing.axis);
}

/* The cell of `axis` in which the ray is just after the crossing of another axis, when it was in `from` some time
 * before; past `end`, the first cell beyond the map's box in the ray's direction, it does not look. */
static double cell_after(const struct traverse_ray *ray, int axis, struct crossing crossing, double from, double end)
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

/* The first cell beyond the map's box in the ray's direction. */
static double end_of(const struct distance_map *map, const struct traverse_ray *ray, int a)
{
    return ray->sign[a] > 0 ? map->last[a] + 1 : map->first[a] - 1;
}

/* Moves all axes but that of the crossing to where they are after it. */
static void catch_up(const struct distance_map *map, const struct traverse_ray *ray, struct crossing crossing,
                     double cell[3])
{
    for (int a = 0; a < 3; a++) {
        if (a != crossing.axis) {
            cell[a] = cell_after(ray, a, crossing, cell[a], end_of(map, ray, a));
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
    struct crossing last = {.t = 0, .axis = -1};
    for (int a = 0; a < 3; a++) {
        out->cell[a] = traverse_cell(ray->origin[a]);
        double face = ray->sign[a] > 0 ? map->first[a] : map->last[a];
        if ((face - out->cell[a]) * ray->sign[a] > 0) {
            double entry = entry_time(ray, a, face);
            if (entry >= last.t) {
                last = (struct crossing){.t = entry, .axis = a};
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
    struct crossing first = {.t = INFINITY, .axis = 0};
    for (int a = 0; a < 3; a++) {
        double t = exit_time(ray, a, place->cell[a] + radius * ray->sign[a]);
        if (t < first.t) {
            first = (struct crossing){.t = t, .axis = a};
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

struct traverse_ray traverse_bundle_at(const struct traverse_bundle *bundle, size_t i)
{
    struct traverse_ray ray;
    double direction[3] = {bundle->direction[0][i], bundle->direction[1][i], bundle->direction[2][i]};
    mat4_direction(direction, bundle->index_from_world, direction);
    traverse_ray_init(&ray, bundle->start, direction);
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

static void walk_one_by_one(const struct distance_map *map, struct traverse_bundle *bundle)
{
    for (size_t i = 0; i < bundle->count; i++) {
        traverse_bundle_ray(map, bundle, i);
    }
}

static bool everywhere(void)
{
    return true;
}

const struct traverse_kernel *traverse_kernel(size_t index)
{
    static const struct traverse_kernel kernels[] = {
#if defined(__x86_64__)
        {.name = "avx512",
         .is_supported = processor_has_avx512,
         .walk = traverse_walk_avx512,
         .pierce = traverse_pierce_avx512},
        {.name = "avx2",
         .is_supported = processor_has_avx2,
         .walk = traverse_walk_avx2,
         .pierce = traverse_pierce_avx2},
        {.name = "sse2", .is_supported = everywhere, .walk = traverse_walk_plain, .pierce = traverse_pierce_plain},
#else
        {.name = "vector", .is_supported = everywhere, .walk = traverse_walk_plain, .pierce = traverse_pierce_plain},
#endif
        {.name = "scalar", .is_supported = everywhere, .walk = walk_one_by_one},
    };
    return index < sizeof kernels / sizeof kernels[0] ? &kernels[index] : NULL;
}

const struct traverse_kernel *traverse_best_kernel(void)
{
    size_t i = 0;
    while (!traverse_kernel(i)->is_supported()) {
        i++;
    }
    return traverse_kernel(i);
}

/* Repeats the last ray. */
static void pad(struct traverse_bundle *bundle)
{
    size_t last = bundle->count - 1;
    for (; bundle->count % TRAVERSE_LANES; bundle->count++) {
        for (int a = 0; a < 3; a++) {
            bundle->direction[a][bundle->count] = bundle->direction[a][last];
        }
        bundle->limit[bundle->count] = bundle->limit[last];
    }
}

/* Sets what follows from the volume; whether kernels can walk the rays. */
static bool aim_at_volume(struct traverse_bundle *bundle, const struct distance_map *map, const struct volume *volume)
{
    bool is_near = bundle->count > 0 && distance_map_codes(map) <= TRAVERSE_CODES;
    bundle->index_from_world = volume->voxel_from_world;
    mat4_point(bundle->start, bundle->index_from_world, bundle->origin);
    for (int a = 0; a < 3; a++) {
        bundle->start_cell[a] = traverse_cell(bundle->start[a]);
        is_near = is_near && fabs(bundle->start[a]) < TRAVERSE_FAR && map->dim[a] <= TRAVERSE_EDGE;
    }
    return is_near;
}

/* Sets what object each hit is. */
static void find_objects(struct traverse_bundle *bundle, const struct volume *volume)
{
    for (size_t i = 0; i < bundle->count; i++) { /* or each would be waited for in turn */
        volume_fetch(volume, bundle->voxel[i]);
    }
    for (size_t i = 0; i < bundle->count; i++) {
        bundle->object[i] = bundle->voxel[i] == UINT64_MAX ? 0 : volume_object(volume, bundle->voxel[i]);
    }
}

void traverse_bundle_walk(const struct traverse_kernel *kernel, const struct distance_map *map,
                          const struct volume *volume, struct traverse_bundle *bundle)
{
    size_t count = bundle->count;
    if (aim_at_volume(bundle, map, volume)) {
        pad(bundle);
        kernel->walk(map, bundle);
    } else {
        walk_one_by_one(map, bundle);
    }
    bundle->count = count;
    if (!map->least) {
        find_objects(bundle, volume);
    }
}

conus_status traverse_bundle_pierce(const struct traverse_kernel *kernel, const struct distance_map *map,
                                    struct traverse_piercing *piercing, struct traverse_bundle *bundle)
{
    conus_status status = CONUS_OK;
    bool by_kernel = aim_at_volume(bundle, map, piercing->volume) && piercing->uniform && kernel->pierce;
    piercing->count = bundle->count;
    if (by_kernel) {
        for (size_t i = 0; i < bundle->count; i++) {
            bundle->limit[i] = INFINITY;
        }
        pad(bundle);
        status = kernel->pierce(piercing, bundle);
        bundle->count = piercing->count;
    }
    for (size_t i = 0; i < bundle->count && !status; i++) {
        if (!by_kernel || piercing->again[i]) {
            struct traverse_ray ray = traverse_bundle_at(bundle, i);
            status = traverse_pierce(piercing->out, map, piercing->volume, &ray, (uint32_t)piercing->pixel[i]);
        }
    }
    return status;
}
